#!/usr/bin/env python3
"""Planned joint angles of the robot's fingers through a grasp of each type.

    build/release/bin/mapping_statistics trace out/mapping.csv
    scripts/plot_mapping.py out/mapping.csv experiments/paper/mapping/figure.png
"""
import csv
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

COLOURS = {"thumb": "#c0392b", "index": "#2471a3", "middle": "#148f77", "ring": "#8e44ad"}


def main():
    source, target = sys.argv[1:3]
    with open(source, newline="") as file:
        rows = list(csv.DictReader(file))
    types = list(dict.fromkeys(row["type"] for row in rows))
    figure, axes = plt.subplots(3, len(types), figsize=(3.1 * len(types), 6.6), sharex=True,
                                sharey="row", constrained_layout=True)
    for column, name in enumerate(types):
        of = [row for row in rows if row["type"] == name]
        t = [float(row["t_of_T"]) for row in of]
        for row, joint in enumerate(["j0", "j1"]):
            axis = axes[row][column]
            for finger, colour in COLOURS.items():
                axis.plot(t, [float(r[f"{finger}_{joint}_wanted"]) for r in of], "--", lw=0.9,
                          color=colour)
                axis.plot(t, [float(r[f"{finger}_{joint}"]) for r in of], lw=1.5, color=colour,
                          label=finger if row == 0 and column == 0 else None)
            if row == 0:
                axis.plot(t, [float(r["palm"]) for r in of], lw=1.2, color="#7f8c8d",
                          label="palm" if column == 0 else None)
        axis = axes[2][column]
        for finger, colour in COLOURS.items():
            involved = max(float(r[f"{finger}_lambda"]) for r in of) > 1
            if involved:
                axis.plot(t, [float(r[f"{finger}_error_mm"]) for r in of], lw=1.5, color=colour)
        axes[0][column].set_title(name)
        axis.set_xlabel("t / T")
        for row in range(3):
            axes[row][column].axvline(1, color="0.8", lw=0.8)
            axes[row][column].spines[["top", "right"]].set_visible(False)
    axes[0][0].set_ylabel("proximal, degrees")
    axes[1][0].set_ylabel("distal, degrees")
    axes[2][0].set_ylabel("tip error, mm\n(involved fingers)")
    axes[0][0].legend(fontsize=7, frameon=False)
    figure.savefig(target, dpi=110)


main()
