#!/usr/bin/env python3
"""Draws the figures of experiments/paper: runs `springgrasp generate` as figure.yaml says, then plots.

Usage: scripts/plot_paper.py experiments/paper/fig2 [--program build/release/bin/springgrasp]
Writes figure.png beside figure.yaml and prints the numbers of its README.
"""

import argparse
import csv
import os
import subprocess
import tempfile

import matplotlib
import numpy as np
import yaml

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

FINGERS = ["thumb", "index", "middle", "ring", "pinkie"]
ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))


def rotation(q):
    w, x, y, z = q
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ])


def read_table(path):
    """Columns of a CSV with comment lines; an empty cell is not a number."""
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    return {k: np.array([float(r[k]) if r[k] else np.nan for r in rows]) for k in rows[0]}


def columns(table, name, parts="xyz"):
    return np.stack([table[f"{name}_{p}"] for p in parts], axis=1)


def tips_in_hand(table):
    """Tips in H, samples x finger x 3, m."""
    p, q = columns(table, "wrist"), columns(table, "wrist", ["qw", "qx", "qy", "qz"])
    out = np.full((len(p), len(FINGERS), 3), np.nan)
    for n in range(len(p)):
        if np.isfinite(q[n]).all():
            for f, finger in enumerate(FINGERS):
                out[n, f] = rotation(q[n]).T @ (columns(table, finger)[n] - p[n])
    return out


def steadied(program, demonstration, kind):
    """The demonstration with the hand as learning sees it."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "steady.csv")
        call = [program, "learn", demonstration, "--type", kind, "-o", os.path.join(folder, "grasp.yaml")]
        subprocess.run(call + ["--steady", path], check=True, stdout=subprocess.DEVNULL)
        return read_table(path)


def generate(program, grasp, run):
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "motion.csv")
        call = [program, "generate", grasp, "--object", run["object"], "--shape", run["shape"], "-o", path]
        for key in ("duration", "start", "yaw"):
            if key in run:
                call += [f"--{key}", str(run[key])]
        subprocess.run(call, check=True, stdout=subprocess.DEVNULL)
        return read_table(path)


def forces(program, figure, grasp):
    fig, axes = plt.subplots(1, 2, figsize=(9, 3.4), sharey=True)
    for axis, run in zip(axes, figure["runs"]):
        table = generate(program, grasp, run)
        axis.plot(table["t"], 1e3 * table["f_cen"], color="tab:blue")
        axis.axhline(0, color="0.7", lw=0.8)
        axis.axvline(run["duration"], color="0.7", lw=0.8, ls=":")
        axis.set_title(run["name"], fontsize=10)
        axis.set_xlabel("t (s)")
        print(f"{run['name']}: f_cen {1e3 * table['f_cen'].min():.1f} to {1e3 * table['f_cen'].max():.1f} mN")
    axes[0].set_ylabel("central force (mN)")
    return fig


def reaches(program, figure, grasp):
    fig = plt.figure(figsize=(10, 4.4))
    for n, part in enumerate(figure["parts"]):
        axis = fig.add_subplot(1, 2, n + 1, projection="3d")
        for run in part["runs"]:
            table = generate(program, grasp, run)
            p = columns(table, "grasp")
            axis.plot(*p.T)
            axis.scatter(*p[0], marker="*", color="k", s=30)
            axis.scatter(*p[-1], marker="s", color="k", s=18)
            goal = np.array([float(x) for x in run["object"].split()[:3]])
            print(f"{part['name']}: goal {goal}, end {np.linalg.norm(p[-1] - goal) * 1e3:.1f} mm from the object's centre")
        axis.set_title(part["name"], fontsize=10)
        axis.set_xlabel("x (m)")
        axis.set_ylabel("y (m)")
        axis.set_zlabel("z (m)")
        axis.tick_params(labelsize=7)
        axis.locator_params(nbins=5)
    return fig


def fingers(program, figure, _):
    names = figure["grasps"]
    fig, axes = plt.subplots(len(names), 5, figsize=(13, 2.9 * len(names)))
    for row, name in zip(axes, names):
        path = os.path.join(ROOT, "models", "grasps", name)
        with open(path + ".yaml", encoding="utf-8") as file:
            learned = yaml.safe_load(file)
        seen = steadied(program, path + ".csv", learned["type"])
        run = {"object": "0 0 0 1 0 0 0", "shape": learned["object"]["shape"]}
        made_table = generate(program, path + ".yaml", run)
        observed, made = tips_in_hand(seen), tips_in_hand(made_table)
        duration = learned["movement"]["duration"]
        inside = made_table["t"] <= duration + 1e-9
        t = seen["t"] - learned["quality"]["begin"]
        during = (t >= -1e-9) & (t <= duration + 1e-9)
        for f, (axis, finger) in enumerate(zip(row, FINGERS)):
            # The two directions in which the finger moves most.
            x = observed[during, f]
            x = x[np.isfinite(x).all(axis=1)]
            middle = x.mean(axis=0)
            plane = np.linalg.svd(x - middle)[2][:2]
            for points, colour, label in ((x, "tab:red", "tracked"), (made[inside, f], "tab:green", "reproduced")):
                flat = 1e3 * (points - middle) @ plane.T
                axis.plot(*flat.T, color=colour, label=label, marker="." if label == "tracked" else None, ms=4, lw=1)
                axis.plot(*flat[0], "*", color=colour, ms=9)
                axis.plot(*flat[-1], "s", color=colour, ms=5)
            axis.set_aspect("equal", adjustable="datalim")
            rmse = 1e3 * learned["quality"]["rmse"][f]
            mark = " *" if finger in learned["involved"] else ""
            axis.set_title(f"{name}, {finger}{mark}: {rmse:.1f} mm", fontsize=10)
            axis.tick_params(labelsize=8)
            print(f"{name} {finger}{mark}: RMSE {rmse:.1f} mm")
        row[0].set_ylabel("mm")
    axes[0, 0].legend(fontsize=7)
    for axis in axes[-1]:
        axis.set_xlabel("mm")
    return fig


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder")
    parser.add_argument("--program", default=os.path.join(ROOT, "build/release/bin/springgrasp"))
    options = parser.parse_args()
    with open(os.path.join(options.folder, "figure.yaml"), encoding="utf-8") as file:
        figure = yaml.safe_load(file)
    draw = {"forces": forces, "reaches": reaches, "fingers": fingers}[figure["kind"]]
    fig = draw(options.program, figure, os.path.join(ROOT, figure.get("grasp", "")))
    fig.tight_layout()
    fig.savefig(os.path.join(options.folder, "figure.png"), dpi=110)


if __name__ == "__main__":
    main()
