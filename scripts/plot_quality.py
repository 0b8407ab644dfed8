#!/usr/bin/env python3
"""How well quality measured when the fingers have closed foretells whether the grasp holds.

Usage: scripts/plot_quality.py RESULTS... [--table t.md] [--figure f.png]

Of every trial that closed its fingers on the object: the quality of its contacts at the end of `grip`
(grip_epsilon, grip_volume, grip_task of the measurements; force closure is epsilon > 0), against what came of it:
held to the end of the disturbances, or dropped or slipped. Receiver operating characteristics; area under each with
the 95 % interval of DeLong, DeLong and Clarke-Pearson, Biometrics 44 (1988), 837. A half says nothing.
"""
import argparse
import math
import pathlib
import sqlite3

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

Z = 1.959963984540054
LOST = {"dropped_lift", "dropped_hold", "dropped_disturb", "slipped"}
HELD = {"success", "wrong_contacts", "dropped_place"}
PREDICTORS = [
    ("epsilon", lambda v: v["grip_epsilon"]),
    ("volume", lambda v: v["grip_volume"]),
    ("task wrench", lambda v: v["grip_task"]),
    ("force closure", lambda v: float(v["grip_epsilon"] > 0)),
    ("normal force of the weakest", lambda v: v["grip_least_normal_n"]),
]


def read(folder):
    """(type, held, measurements) of the trials that closed their fingers."""
    con = sqlite3.connect(f"file:{pathlib.Path(folder) / 'results.sqlite'}?mode=ro", uri=True)
    values = {}
    for trial, name, value in con.execute("SELECT id, name, value FROM measurements WHERE name LIKE 'grip_%'"):
        values.setdefault(trial, {})[name] = value
    trials = []
    for trial, case, outcome in con.execute("SELECT id, case_name, outcome FROM trials JOIN results USING (id) "
                                            "ORDER BY position"):
        if "grip_epsilon" in values.get(trial, {}) and outcome in LOST | HELD:
            trials.append((case.split(",")[0].split(" ")[0], outcome in HELD, values[trial]))
    return trials


def area(held, lost):
    """Area under the curve with its interval: the chance that a grasp that holds has the higher quality."""
    def above(x, others):
        return sum((x > y) + 0.5 * (x == y) for y in others) / len(others)

    of_held = [above(x, lost) for x in held]
    of_lost = [1 - above(y, held) for y in lost]
    auc = sum(of_held) / len(held)

    def variance(values):
        return sum((v - auc) ** 2 for v in values) / max(1, len(values) - 1) / len(values)

    half = Z * math.sqrt(variance(of_held) + variance(of_lost))
    return auc, max(0.0, auc - half), min(1.0, auc + half)


def curve(held, lost):
    thresholds = sorted(set(held) | set(lost), reverse=True)
    x, y = [0.0], [0.0]
    for t in thresholds:
        x.append(sum(v >= t for v in lost) / len(lost))
        y.append(sum(v >= t for v in held) / len(held))
    return x, y


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", nargs="+")
    parser.add_argument("--table")
    parser.add_argument("--figure")
    options = parser.parse_args()
    trials = [t for folder in options.results for t in read(folder)]
    kinds = [k for k in dict.fromkeys(t[0] for t in trials)
             if len({held for kind, held, _ in trials if kind == k}) == 2]
    if not kinds:
        parser.error("needs grasps that held and grasps that were lost, of the same type")
    lines = ["| | held, lost | " + " | ".join(name for name, _ in PREDICTORS) + " |", "|---" * (2 + len(PREDICTORS)) + "|"]
    figure, axes = plt.subplots(1, len(kinds), figsize=(3.0 * len(kinds), 3.4), dpi=120, squeeze=False, sharey=True)
    for ax, kind in zip(axes[0], kinds):
        held = [v for k, h, v in trials if k == kind and h]
        lost = [v for k, h, v in trials if k == kind and not h]
        cells = []
        for name, of in PREDICTORS:
            a, b = [of(v) for v in held], [of(v) for v in lost]
            auc, low, high = area(a, b)
            cells.append(f"{auc:.2f} ({low:.2f} to {high:.2f})")
            ax.plot(*curve(a, b), label=name)
        ax.plot([0, 1], [0, 1], color="#999999", lw=0.8)
        ax.set_title(f"{kind}: {len(held)} held, {len(lost)} lost", fontsize=9)
        ax.set_xlabel("of the lost above the threshold", fontsize=8)
        lines.append(f"| {kind} | {len(held)}, {len(lost)} | " + " | ".join(cells) + " |")
    axes[0][0].set_ylabel("of the held above the threshold", fontsize=8)
    handles, names = axes[0][0].get_legend_handles_labels()
    figure.legend(handles, names, fontsize=8, ncol=len(names), loc="upper center")
    text = "\n".join(lines) + "\n"
    print(text, end="")
    if options.table:
        pathlib.Path(options.table).write_text(text)
    if options.figure:
        figure.tight_layout(rect=(0, 0, 1, 0.93))
        figure.savefig(options.figure)


if __name__ == "__main__":
    main()
