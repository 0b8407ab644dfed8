#!/usr/bin/env python3
"""Plots step responses of the hand's drives from the CSV that `springgrasp inspect MODEL --drives FILE` writes.

Usage: scripts/plot_drives.py DRIVES.csv -o step_response.png [--hand hand_r]
"""

import argparse
import csv

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402


def read(path, hand):
    """Series (t, bar, rad) and step pressure by valve, without the hand's prefix."""
    valves = {}
    with open(path, newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            if not row["valve"].startswith(hand + "_"):
                continue
            name = row["valve"].removeprefix(hand + "_").replace("_", " ")
            series = valves.setdefault(name, {"pressure": float(row["pressure_bar"]), "t": [], "p": [], "q": []})
            series["t"].append(float(row["t"]))
            series["p"].append(float(row["chamber_bar"]))
            series["q"].append(float(row["angle_rad"]))
    return valves


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("drives")
    parser.add_argument("-o", "--output", required=True)
    parser.add_argument("--hand", default="hand_r")
    options = parser.parse_args()
    valves = read(options.drives, options.hand)
    if not valves:
        parser.error(f"{options.drives} holds no valve of {options.hand}")
    figure, (left, right) = plt.subplots(1, 2, figsize=(10.5, 4.2), constrained_layout=True)
    styles = ["-", "--", "-.", ":"]
    for i, (name, series) in enumerate(valves.items()):
        style = styles[i % len(styles)]
        label = f"{name}, {series['pressure']:.2f} bar"
        left.plot(series["t"], [p / series["pressure"] for p in series["p"]], style, label=label)
        right.plot(series["t"], series["q"], style, label=label)
    left.axhline(0.632, color="0.6", linewidth=0.8)
    left.axvline(0.1, color="0.6", linewidth=0.8)
    left.text(0.11, 0.04, "0.1 s", color="0.4")
    left.set(xlim=(0, 0.6), ylim=(0, 1.05), xlabel="time, s", ylabel="chamber pressure / commanded",
             title="Chamber")
    right.set(xlim=(0, 2), ylim=(0, None), xlabel="time, s", ylabel="joint angle (first of the valve), rad",
              title="Joint")
    right.legend(fontsize=8, loc="center right")
    for axes in (left, right):
        axes.grid(alpha=0.3)
    figure.savefig(options.output, dpi=110)


if __name__ == "__main__":
    main()
