#!/usr/bin/env python3
"""Strips of a grasp as shown, as planned for the human hand, and as the robot performed it.

    scripts/grasp_strips.py out/strips experiments/paper/fig7_8
"""
import csv
import pathlib
import subprocess
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

PROGRAM = "build/release/bin/springgrasp"
PARTS = [0.05, 0.4, 0.65, 0.85, 1.0]  # of the reach
SCENES = {"power": "power_cylinder", "pinch": "pinch_ball", "tripod": "tripod_cylinder", "lateral": "lateral_plate"}
PERFORMED = [*PARTS, "hold"]


def run(*command):
    subprocess.run([str(part) for part in command], check=True, stdout=subprocess.DEVNULL)


def frame(video, t, picture):
    run("ffmpeg", "-loglevel", "error", "-y", "-ss", f"{t:.3f}", "-i", video, "-frames:v", 1, picture)
    return picture


def shown(kind, folder):
    """Pictures of the left eye at the parts of the demonstration."""
    frames = folder / f"{kind}_frames"
    run(PROGRAM, "observe", f"scenes/show_{kind}.yaml", "-o", folder / f"{kind}.csv", "--save-frames", frames)
    left = sorted(p for p in frames.iterdir() if "left" in p.name or p.name.startswith("l"))
    lead = round(0.5 * 30)  # frames of the lead-in
    moving = left[lead:] if len(left) > lead else left
    return [moving[min(len(moving) - 1, round(part * (len(moving) - 1)))] for part in PARTS]


def performed(kind, folder):
    out, video = folder / f"{kind}_robot", folder / f"{kind}.mp4"
    run(PROGRAM, "perform", f"models/grasps/{kind}.yaml", "--scene", f"scenes/{SCENES[kind]}.yaml", "-o", out,
        "--video", video, "--camera", "close")
    with open(out / "trajectory.csv") as file:
        rows = list(csv.DictReader(file))
    reach = [float(r["t"]) for r in rows if r["phase"] == "reach"]
    start, end = reach[0], reach[0] + (reach[-1] - reach[0]) / 1.5  # the reach runs on to 1.5 T
    hold = next(float(r["t"]) for r in rows if r["phase"] == "hold")
    times = [start + part * (end - start) for part in PARTS[:-1]] + [reach[-1], hold]
    pictures = [frame(video, t, folder / f"{kind}_robot_{i}.png") for i, t in enumerate(times)]
    return pictures, rows


def strip(kind, folder, target):
    top = shown(kind, folder)
    middle = [folder / f"{kind}_{round(100 * part):03d}.png" for part in PARTS]
    bottom = performed(kind, folder)[0] if kind in SCENES else []
    rows = [("shown", top), ("planned for the MMM hand", middle)] + ([("performed", bottom)] if bottom else [])
    figure, axes = plt.subplots(len(rows), len(PERFORMED), figsize=(16, 2.5 * len(rows)), squeeze=False)
    for row, (name, pictures) in zip(axes, rows):
        for cell in row:
            cell.axis("off")
        for cell, picture in zip(row, pictures):
            cell.imshow(plt.imread(str(picture)))
        row[0].set_title(name, fontsize=10, loc="left")
    for part, cell in zip(PERFORMED, axes[-1]):
        label = "held" if part == "hold" else "closed" if part == 1.0 else f"{part:.2f} T"
        cell.text(0.5, -0.08, label, transform=cell.transAxes, ha="center", fontsize=10)
    figure.tight_layout()
    figure.savefig(target / f"{kind}.png", dpi=60)
    plt.close(figure)


def tracking(folder, target):
    """Planned and reached joint angles and fingertips of the performed grasps."""
    figure, axes = plt.subplots(3, len(SCENES), figsize=(16, 10), sharex="col")
    joints = ["palm", "thumb_j0", "thumb_j1", "index_j0", "index_j1", "middle_j0", "middle_j1"]
    for column, kind in enumerate(SCENES):
        with open(folder / f"{kind}_robot" / "trajectory.csv") as file:
            rows = [r for r in csv.DictReader(file) if r["phase"] in ("reach", "grip", "lift")]
        t = [float(r["t"]) for r in rows]
        for i, joint in enumerate(joints):
            planned = [57.2958 * float(r[f"hand_planned_{joint}"]) for r in rows]
            reached = [57.2958 * float(r[f"hand_{joint}"]) for r in rows]
            axes[0][column].plot(t, planned, "--", color=f"C{i}", lw=1)
            axes[0][column].plot(t, reached, color=f"C{i}", lw=1.2, label=joint)
        for i, finger in enumerate(["thumb", "index", "middle"]):
            if all(float(r[f"{finger}_force_target_n"]) == 0 for r in rows):
                continue
            axes[1][column].plot(t, [float(r[f"{finger}_force_target_n"]) for r in rows], "--", color=f"C{i}", lw=1)
            axes[1][column].plot(t, [float(r[f"{finger}_normal_n"]) for r in rows], color=f"C{i}", lw=1.2, label=finger)
        for i, finger in enumerate(["thumb", "index", "middle"]):
            off = [1e3 * sum((float(r[f"{finger}_{a}"]) - float(r[f"{finger}_planned_{a}"])) ** 2 for a in "xyz") ** 0.5
                   for r in rows if r["phase"] != "lift"]
            axes[2][column].plot(t[:len(off)], off, color=f"C{i}", lw=1.2, label=finger)
        axes[0][column].set_title(kind)
        for row in axes:
            for phase in ("grip", "lift"):
                start = next(float(r["t"]) for r in rows if r["phase"] == phase)
                row[column].axvline(start, color="0.7", lw=0.8)
        axes[2][column].set_xlabel("t (s): reach | grip | lift")
    axes[0][0].set_ylabel("angle (degrees), planned dashed")
    axes[1][0].set_ylabel("normal force (N), asked for dashed")
    axes[2][0].set_ylabel("fingertip off its plan (mm)")
    axes[2][0].legend(fontsize=7)
    axes[0][0].legend(fontsize=7)
    axes[1][0].legend(fontsize=7)
    figure.tight_layout()
    figure.savefig(target / "planned_reached.png", dpi=70)


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    folder, target = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    target.mkdir(parents=True, exist_ok=True)
    run("build/release/bin/grasp_strip", folder)
    for kind in ("power", "pinch", "tripod", "lateral"):
        strip(kind, folder, target)
    tracking(folder, target)


if __name__ == "__main__":
    main()
