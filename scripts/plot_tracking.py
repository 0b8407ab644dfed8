#!/usr/bin/env python3
"""Tables and figure of experiments/tracking out of a results directory.

Usage: scripts/plot_tracking.py RESULTS [--table table.md] [--figure figure.png]

Pools the frames of all trials of a condition (four grasps, all repetitions). A fingertip counts
while both eyes see at least 30 % of its cap.
"""
import argparse
import csv
import pathlib
import sqlite3

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

FINGERS = ["thumb", "index", "middle", "ring", "pinkie"]
VISIBLE = 0.3
GRASPS = ["pinch", "tripod", "power", "lateral"]
# Bars: fingertip median and 95 %, hand median and 95 % in mm and degrees, swaps in % of frames.
BARS = {"clean": (1.5, 5, 8, 20, 6, 15, 0), "moderate": (3, 8, 16, 40, 12, 30, 0.5)}
# Panels of the figure: condition and axis.
SWEEPS = [
    ("distance", "distance, m"),
    ("speed", "peak wrist speed, m/s"),
    ("noise", "noise, grey values"),
    ("blur", "exposure at 1 m/s, s"),
    ("lighting", "change of light"),
    ("white_balance", "change of white balance"),
    ("occlusion", "frames hidden (index)"),
    ("clutter", "things in the background"),
    ("drops", "share of frames dropped"),
    ("offset", "right eye late, s"),
    ("calibration", "right camera turned, rad"),
]


def number(text):
    return float(text) if text else np.nan


def words_of(word, case):
    """"demonstrator.distance=0.4" -> "0.4" of the case distance, "distance 0.4" of another."""
    key, given, value = word.partition("=")
    key = key.split(".")[-1]
    return (value if key == case else f"{key} {value}") if given else word


class Pool:
    """All frames of one condition."""

    def __init__(self):
        self.sequences = self.untracked = self.frames = self.swaps = 0
        self.hidden = self.recovered = 0
        self.slowest = 0
        self.visible = self.tracked = 0
        self.errors = {finger: [] for finger in FINGERS}
        self.wrist, self.rotation, self.epipolar = [], [], []

    def add(self, rows, values, outcome):
        self.sequences += 1
        self.untracked += outcome != "success"
        self.hidden += int(values.get("hidden", 0))
        self.recovered += int(values.get("recovered_in_5", 0))
        self.slowest = max(self.slowest, int(values.get("recovery_frames", 0)))
        if "epipolar_px" in values:
            self.epipolar.append(values["epipolar_px"])
        for row in rows:
            self.frames += 1
            self.swaps += bool(row["swapped"])
            for finger in FINGERS:
                if float(row[finger + "_visible"]) < VISIBLE:
                    continue
                self.visible += 1
                error = number(row[finger + "_m"])
                if np.isnan(error):
                    continue
                self.tracked += 1
                self.errors[finger].append(1e3 * error)
            wrist, rotation = number(row["wrist_m"]), number(row["rotation_rad"])
            if not np.isnan(wrist):
                self.wrist.append(1e3 * wrist)
            if not np.isnan(rotation):
                self.rotation.append(np.degrees(rotation))

    def all_errors(self):
        return np.concatenate([self.errors[finger] for finger in FINGERS])

    def numbers(self):
        tips = self.all_errors()
        return {
            "median": quantile(tips, 0.5),
            "p95": quantile(tips, 0.95),
            "hand_mm": quantile(self.wrist, 0.5),
            "hand_95_mm": quantile(self.wrist, 0.95),
            "hand_deg": quantile(self.rotation, 0.5),
            "hand_95_deg": quantile(self.rotation, 0.95),
            "swaps": 100 * self.swaps / max(1, self.frames),
            "coverage": 100 * self.tracked / max(1, self.visible),
        }


def quantile(values, fraction):
    return float(np.quantile(values, fraction)) if len(values) else np.nan


def load(results):
    """Condition (name without the grasp) -> Pool, for all grasps and for each."""
    base = sqlite3.connect(f"file:{results / 'results.sqlite'}?mode=ro", uri=True)
    values = {}
    for trial, name, value in base.execute("select id, name, value from measurements"):
        values.setdefault(trial, {})[name] = value
    pools, of_grasp = {}, {}
    query = (
        "select trials.id, case_name, outcome from trials join results on trials.id = results.id"
        " order by position"
    )
    for trial, case, outcome in base.execute(query):
        record = results / "trials" / trial / "tracking.csv"
        if outcome == "error" or not record.exists():
            print(f"left out: {case} ({outcome})")
            continue
        words = case.split()
        grasp = next(word for word in words if word in GRASPS)
        words.remove(grasp)
        name = " ".join(words_of(word, words[0]) for word in words)
        with open(record) as file:
            rows = list(csv.DictReader(file))
        if "clean" in words or "moderate" in words:
            pooled = " ".join(word for word in words if "=" not in word)
            of_grasp.setdefault(f"{pooled}, {grasp}", Pool()).add(
                rows, values.get(trial, {}), outcome
            )
            name = pooled
        pools.setdefault(name, Pool()).add(rows, values.get(trial, {}), outcome)
    return pools, of_grasp


def table(pools):
    lines = [
        "| condition | sequences | untracked | frames | tip median mm | 95 % mm | thumb, index, middle,"
        " ring, pinkie mm | H median, 95 % mm | H median, 95 % ° | swaps % | coverage % | recovered"
        " in 5 | slowest | epipolar px |",
        "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|",
    ]
    for name, pool in pools.items():
        n = pool.numbers()
        fingers = ", ".join(f"{quantile(pool.errors[f], 0.5):.1f}" for f in FINGERS)
        recovered = f"{pool.recovered} of {pool.hidden}" if pool.hidden else ""
        lines.append(
            f"| {name} | {pool.sequences} | {pool.untracked} | {pool.frames} | {n['median']:.2f} |"
            f" {n['p95']:.2f} | {fingers} | {n['hand_mm']:.1f}, {n['hand_95_mm']:.1f} |"
            f" {n['hand_deg']:.1f}, {n['hand_95_deg']:.1f} | {n['swaps']:.2f} |"
            f" {n['coverage']:.1f} | {recovered} | {pool.slowest if pool.hidden else ''} |"
            f" {quantile(pool.epipolar, 0.5):.2f} |"
        )
    return "\n".join(lines)


def verdicts(pools):
    """Each bar that a condition has, and whether it holds."""
    lines = []
    for name, bars in BARS.items():
        if name not in pools:
            continue
        n = pools[name].numbers()
        keys = ["median", "p95", "hand_mm", "hand_95_mm", "hand_deg", "hand_95_deg", "swaps"]
        for key, bar in zip(keys, bars):
            held = "holds" if n[key] <= bar else "MISSED"
            lines.append(f"{name}: {key} {n[key]:.2f}, at most {bar}: {held}")
    return lines


def sweep(pools, case):
    points = []
    for name, pool in pools.items():
        words = name.split()
        if words[0] == case and len(words) > 1:
            points.append((float(words[-1]), pool))
    return sorted(points, key=lambda point: point[0])


def draw(pools, path):
    shown = [panel for panel in SWEEPS if sweep(pools, panel[0])]
    columns = 4
    rows = -(-(len(shown) + 1) // columns)
    figure, axes = plt.subplots(rows, columns, figsize=(3.6 * columns, 2.9 * rows))
    axes = np.atleast_1d(axes).ravel()
    first = axes[0]
    for name, colour in [
        ("clean", "#1a7f4b"),
        ("moderate", "#1f5fbf"),
        ("paper clean", "#8fcfae"),
        ("paper moderate", "#9dbdea"),
    ]:
        if name not in pools:
            continue
        tips = np.sort(pools[name].all_errors())
        if len(tips) == 0:
            continue
        # The share of visible fingertips that are tracked to within an error.
        first.plot(tips, 100 * np.arange(1, len(tips) + 1) / pools[name].visible, color=colour,
                   label=name)
    first.set_xscale("log")
    first.set_xlim(0.1, 100)
    first.set_ylim(0, 101)
    first.set_xlabel("fingertip error, mm")
    first.set_ylabel("visible fingertips, %")
    first.grid(alpha=0.3)
    first.legend(fontsize=7)
    for axis, (case, label) in zip(axes[1:], shown):
        points = sweep(pools, case)
        x = [value for value, _ in points]
        numbers = [pool.numbers() for _, pool in points]
        axis.plot(x, [n["median"] for n in numbers], "o-", color="#1f5fbf", label="median")
        axis.plot(x, [n["p95"] for n in numbers], "s--", color="#c0392b", label="95 %")
        axis.plot(x, [n["hand_mm"] for n in numbers], "^:", color="#777777", label="H, median")
        axis.set_yscale("log")
        axis.set_ylim(0.3, 100)
        axis.set_xlabel(label)
        axis.set_ylabel("error, mm")
        axis.grid(alpha=0.3)
        other = axis.twinx()
        other.bar(x, [100 - n["coverage"] for n in numbers], color="#888888", alpha=0.35,
                  width=0.04 * (max(x) - min(x) or 1), label="not tracked")
        other.set_ylim(0, 50)
        other.set_ylabel("not tracked, %", fontsize=8, color="#666666")
    if len(axes) > 1 and shown:
        axes[1].legend(fontsize=7)
    for axis in axes[len(shown) + 1 :]:
        axis.axis("off")
    figure.tight_layout()
    figure.savefig(path, dpi=110)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("results", type=pathlib.Path)
    parser.add_argument("--table", type=pathlib.Path)
    parser.add_argument("--figure", type=pathlib.Path)
    options = parser.parse_args()
    pools, of_grasp = load(options.results)
    text = table(pools) + "\n\nBy grasp:\n\n" + table(of_grasp)
    print(text)
    print("\n".join(verdicts(pools)))
    if options.table:
        options.table.write_text(text + "\n")
    if options.figure:
        draw(pools, options.figure)


if __name__ == "__main__":
    main()
