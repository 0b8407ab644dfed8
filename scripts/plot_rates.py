#!/usr/bin/env python3
"""Tables and figure of success rates out of a results directory.

Usage: scripts/plot_rates.py RESULTS [--table t.md] [--figure f.png] [--paired WHAT] [--sizes]

Rates with their 95 % Wilson intervals, the outcomes of what was lost, medians of what was measured.
--paired baselines: each baseline against the springs, same draws. --paired first: each case
"GRASP, NAME" against the first case of its GRASP, which has a row of bars in the figure. Differences
of paired rates with the interval of Agresti and Min, Statistics in Medicine 24 (2005), 729: half a
trial added to each cell.
--sizes: the figure shows success over the object's smallest width, one line per case.
"""
import argparse
import collections
import math
import pathlib
import re
import sqlite3

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

Z = 1.959963984540054
NOT_HELD = ["unreachable", "untracked", "collided", "missed", "dropped_lift", "dropped_hold", "diverged", "error"]


def wilson(k, n):
    """95 % interval of a rate."""
    if n == 0:
        return 0.0, 1.0
    p, z2 = k / n, Z * Z
    mid = (p + z2 / (2 * n)) / (1 + z2 / n)
    half = Z / (1 + z2 / n) * math.sqrt(p * (1 - p) / n + z2 / (4 * n * n))
    return max(0.0, mid - half), min(1.0, mid + half)


def paired(wins, losses, n):
    """Difference of two paired rates with its 95 % interval; wins and losses are the discordant pairs."""
    b, c, m = wins + 0.5, losses + 0.5, n + 2
    d = (b - c) / m
    half = Z * math.sqrt(max(0.0, (b + c) - (b - c) ** 2 / m)) / m
    return (wins - losses) / n, max(-1.0, d - half), min(1.0, d + half)


def median(values):
    values = sorted(values)
    n = len(values)
    return (values[(n - 1) // 2] + values[n // 2]) / 2 if n else None


class Condition:
    def __init__(self, case, baseline):
        self.case, self.baseline = case, baseline
        self.outcome = {}  # (demonstration, repetition) -> outcome
        self.values = collections.defaultdict(list)

    @property
    def label(self):
        return self.case if self.baseline == "none" else f"{self.case} ({self.baseline})"

    @property
    def n(self):
        return len(self.outcome)

    @property
    def successes(self):
        return sum(o == "success" for o in self.outcome.values())

    @property
    def held(self):
        return sum(o not in NOT_HELD for o in self.outcome.values())


def read(folder):
    """Conditions in the order of the plan; trials that have not been run are left out."""
    con = sqlite3.connect(f"file:{pathlib.Path(folder) / 'results.sqlite'}?mode=ro", uri=True)
    conditions = {}
    of = {}
    rows = con.execute("SELECT id, case_name, demonstration, baseline, repetition, outcome FROM trials "
                       "JOIN results USING (id) ORDER BY position")
    for trial, case, demonstration, baseline, repetition, outcome in rows:
        c = conditions.setdefault((case, baseline), Condition(case, baseline))
        c.outcome[demonstration, repetition] = outcome
        of[trial] = c
    for trial, name, value in con.execute("SELECT id, name, value FROM measurements"):
        if trial in of and name in ("creep_mm_s", "slip_mm", "tracking_median_mm", "place_error_mm", "finger_error_mm"):
            of[trial].values[name].append(value)
    return list(conditions.values())


def lost(c):
    counts = collections.Counter(o for o in c.outcome.values() if o != "success")
    return ", ".join(f"{n} {o}" for o, n in counts.most_common()) or "-"


def rates_table(conditions):
    lines = ["| | success | 95 % interval | held to the forces | lost | creep, mm/s |", "|---|---|---|---|---|---|"]
    for c in conditions:
        low, high = wilson(c.successes, c.n)
        creep = median(c.values["creep_mm_s"])
        creep = "-" if creep is None else f"{creep:.3f}"
        lines.append(f"| {c.label} | {c.successes} of {c.n} | {low:.2f} to {high:.2f} | {c.held} | {lost(c)} | {creep} |")
    return lines


def reference_of(c, conditions, how):
    if how == "baselines":
        return None if c.baseline == "none" else next(
            (r for r in conditions if r.case == c.case and r.baseline == "none"), None)
    first = next(r for r in conditions if r.case.split(",")[0] == c.case.split(",")[0])
    return None if first is c else first


def difference(c, reference):
    """Successes of c less those of the reference where both were run: rate, low, high, pairs."""
    both = sorted(set(c.outcome) & set(reference.outcome))
    wins = sum(c.outcome[r] == "success" != reference.outcome[r] for r in both)
    losses = sum(c.outcome[r] != "success" == reference.outcome[r] for r in both)
    return (*paired(wins, losses, len(both)), len(both))


def paired_table(conditions, how):
    first = "springs less baseline" if how == "baselines" else "difference"
    lines = [f"| | pairs | {first}, points | 95 % interval |", "|---|---|---|---|"]
    pooled = {}
    for c in conditions:
        reference = reference_of(c, conditions, how)
        if reference is None:
            continue
        d, low, high, n = difference(c, reference)
        if how == "baselines":
            d, low, high = -d, -high, -low
        lines.append(f"| {c.label} | {n} | {100 * d:+.0f} | {100 * low:+.0f} to {100 * high:+.0f} |")
        if how == "first":
            name = c.case.split(",", 1)[1].strip()
            for r in set(c.outcome) & set(reference.outcome):
                p = pooled.setdefault(name, [0, 0, 0])
                p[0] += c.outcome[r] == "success" != reference.outcome[r]
                p[1] += c.outcome[r] != "success" == reference.outcome[r]
                p[2] += 1
    for name, (wins, losses, n) in pooled.items():
        d, low, high = paired(wins, losses, n)
        lines.append(f"| all, {name} | {n} | {100 * d:+.1f} | {100 * low:+.1f} to {100 * high:+.1f} |")
    return lines


def draw_bars(conditions, path):
    names = list(dict.fromkeys(c.case for c in conditions))
    kinds = list(dict.fromkeys(c.baseline for c in conditions))
    fig, ax = plt.subplots(figsize=(max(4.0, 0.9 + 0.45 * len(names) * (1 + len(kinds))), 3.6), dpi=120)
    width = 0.8 / len(kinds)
    for k, kind in enumerate(kinds):
        chosen = [(names.index(c.case), c) for c in conditions if c.baseline == kind]
        x = [i + (k - (len(kinds) - 1) / 2) * width for i, _ in chosen]
        y = [c.successes / c.n for _, c in chosen]
        bounds = [wilson(c.successes, c.n) for _, c in chosen]
        error = [[max(0.0, v - b[0]) for v, b in zip(y, bounds)], [max(0.0, b[1] - v) for v, b in zip(y, bounds)]]
        ax.bar(x, y, 0.92 * width, yerr=error, capsize=3, label="springs" if kind == "none" else kind)
    ax.set_xticks(range(len(names)))
    ax.set_xticklabels([n.replace(" objects.0.shape=", "\n") for n in names],
                       rotation=0 if len(names) < 6 else 75, fontsize=8)
    ax.set_ylim(0, 1.02)
    ax.set_ylabel("success")
    ax.grid(axis="y", alpha=0.3)
    if len(kinds) > 1:
        ax.legend(fontsize=8, ncol=len(kinds), loc="lower center", bbox_to_anchor=(0.5, 1.0))
    fig.tight_layout()
    fig.savefig(path)


def draw_settings(conditions, path):
    """Cases "GRASP, NAME": a row of bars for each grasp above the same names."""
    grasps = list(dict.fromkeys(c.case.split(", ", 1)[0] for c in conditions))
    names = list(dict.fromkeys(c.case.split(", ", 1)[-1] for c in conditions))
    fig, axes = plt.subplots(len(grasps), 1, sharex=True, squeeze=False, dpi=120,
                             figsize=(max(5.0, 0.62 * len(names)), 0.9 + 1.15 * len(grasps)))
    for grasp, ax in zip(grasps, axes[:, 0]):
        mine = [c for c in conditions if c.case.split(", ", 1)[0] == grasp]
        x = [names.index(c.case.split(", ", 1)[-1]) for c in mine]
        y = [c.successes / c.n for c in mine]
        bounds = [wilson(c.successes, c.n) for c in mine]
        error = [[max(0.0, v - b[0]) for v, b in zip(y, bounds)], [max(0.0, b[1] - v) for v, b in zip(y, bounds)]]
        ax.bar(x, y, 0.75, yerr=error, capsize=3)
        ax.set_ylim(0, 1.04)
        ax.set_yticks([0, 0.5, 1])
        ax.set_ylabel(grasp)
        ax.grid(axis="y", alpha=0.3)
    axes[-1, 0].set_xticks(range(len(names)))
    axes[-1, 0].set_xticklabels(names, rotation=40, ha="right", fontsize=8)
    fig.tight_layout()
    fig.savefig(path)


def draw_sizes(conditions, path):
    lines = collections.defaultdict(list)
    for c in conditions:
        name, given, shape = c.case.partition(" objects.0.shape=")
        if given:
            width = 1e3 * min(float(v) for v in re.findall(r"\d*\.\d+", shape))
            lines[f"{name}, {shape.split(':')[0]}"].append((width, c))
    fig, ax = plt.subplots(figsize=(6.4, 3.8), dpi=120)
    for k, (name, points) in enumerate(lines.items()):
        points.sort(key=lambda p: p[0])
        x = [p[0] + 0.25 * (k - len(lines) / 2) for p in points]
        y = [p[1].successes / p[1].n for p in points]
        bounds = [wilson(p[1].successes, p[1].n) for p in points]
        error = [[max(0.0, v - b[0]) for v, b in zip(y, bounds)], [max(0.0, b[1] - v) for v, b in zip(y, bounds)]]
        ax.errorbar(x, y, yerr=error, marker="o", capsize=3, label=name)
    ax.set_ylim(0, 1.03)
    ax.set_xlabel("smallest width of the object, mm")
    ax.set_ylabel("success")
    ax.grid(alpha=0.3)
    ax.legend(fontsize=8)
    fig.tight_layout()
    fig.savefig(path)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results")
    parser.add_argument("--table")
    parser.add_argument("--figure")
    parser.add_argument("--paired", choices=["baselines", "first"])
    parser.add_argument("--sizes", action="store_true")
    options = parser.parse_args()
    conditions = read(options.results)
    if not conditions:
        parser.error(f"{options.results} holds no finished trial")
    lines = rates_table(conditions)
    if options.paired:
        lines += [""] + paired_table(conditions, options.paired)
    text = "\n".join(lines) + "\n"
    print(text, end="")
    if options.table:
        pathlib.Path(options.table).write_text(text)
    if options.figure:
        draw = draw_sizes if options.sizes else draw_settings if options.paired == "first" else draw_bars
        draw(conditions, options.figure)


if __name__ == "__main__":
    main()
