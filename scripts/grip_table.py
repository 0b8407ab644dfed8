#!/usr/bin/env python3
"""Table of experiments/grip: what was lost, forces against those asked for, the arm's errors.

    build/release/bin/springgrasp export out/grip -o out/grip.csv
    scripts/grip_table.py out/grip.csv
"""
import csv
import statistics
import sys

HELD = ("success", "dropped_disturb", "slipped", "wrong_contacts")
FINGERS = ("thumb", "index", "middle", "ring", "pinkie")


def numbers(rows, key):
    return [float(row[key]) for row in rows if row.get(key)]


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    with open(sys.argv[1]) as file:
        rows = list(csv.DictReader(file))
    print("| grasp | trials | lost before `disturb` | success | force held / asked for, by finger: median (least to most), N | "
          "largest force of any finger at any time, N | regrips |")
    print("|---|---|---|---|---|---|---|")
    for case in dict.fromkeys(row["case"] for row in rows):
        mine = [row for row in rows if row["case"] == case]
        held = [row for row in mine if row["outcome"] in HELD]
        cells = []
        for finger in FINGERS:
            asked, found = numbers(held, f"force_target_{finger}_n"), numbers(held, f"force_hold_{finger}_n")
            if asked and statistics.median(asked) > 0:
                ratios = [f / a for f, a in zip(found, asked)]
                cells.append(f"{finger} {statistics.median(found):.1f} / {statistics.median(asked):.1f} "
                             f"({min(ratios):.2f} to {max(ratios):.2f})")
        largest = max(max(numbers(mine, f"largest_force_{finger}_n"), default=0) for finger in FINGERS)
        print(f"| {case} | {len(mine)} | {len(mine) - len(held)} | {sum(r['outcome'] == 'success' for r in mine)} | "
              f"{'; '.join(cells)} | {largest:.1f} | {sum(numbers(held, 'regrips')):.0f} |")
    print("\n| grasp | hand pose off its plan, last 20 % of the reach: median / worst | in the hold: median / worst |")
    print("|---|---|---|")
    for case in dict.fromkeys(row["case"] for row in rows):
        mine = [row for row in rows if row["case"] == case]
        text = []
        for window in ("late", "hold"):
            mm, deg = numbers(mine, f"arm_{window}_error_mm"), numbers(mine, f"arm_{window}_error_deg")
            text.append(f"{statistics.median(mm):.2f} / {max(mm):.2f} mm, {statistics.median(deg):.2f} / {max(deg):.2f}°"
                        if mm else "-")
        print(f"| {case} | {text[0]} | {text[1]} |")
    print("\noutcomes: " + ", ".join(f"{case} {outcome} {count}" for (case, outcome), count in sorted(
        {(r["case"], r["outcome"]): sum(x["case"] == r["case"] and x["outcome"] == r["outcome"] for x in rows)
         for r in rows}.items())))
    for key in ("beyond_arm_torque_nm", "beyond_arm_torque_s", "below_ambient_bar", "beyond_supply_bar",
                "beyond_arm_range_deg", "beyond_hand_range_deg"):
        values = numbers(rows, key)
        print(f"{key}: {sum(v > 0 for v in values)} of {len(values)} trials, largest {max(values, default=0):.3g}")


if __name__ == "__main__":
    main()
