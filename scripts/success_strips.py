#!/usr/bin/env python3
"""Picture strips of grasps: a row for each case of a run, its first success; replayed if it was not filmed.

Usage: scripts/success_strips.py RESULTS [RESULTS ...] -o strips.png [--program build/release/bin/springgrasp]
"""
import argparse
import pathlib
import sqlite3
import subprocess
import tempfile

TIMES = [1.3, 1.9, 2.7, 5.2, 7.2]  # s: on the way, there, closed, lifting, held
WIDTH = 300  # px, of one picture


def first_successes(folder):
    con = sqlite3.connect(f"file:{pathlib.Path(folder) / 'results.sqlite'}?mode=ro", uri=True)
    rows = con.execute("SELECT case_name, id FROM trials JOIN results USING (id) "
                       "WHERE outcome = 'success' AND baseline = 'none' ORDER BY position")
    chosen = {}
    for case, trial in rows:
        chosen.setdefault(case, trial)
    return chosen


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", nargs="+")
    parser.add_argument("-o", "--output", required=True)
    parser.add_argument("--program", default="build/release/bin/springgrasp")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        rows = []
        for folder in options.results:
            for case, trial in first_successes(folder).items():
                video = pathlib.Path(folder) / "trials" / trial / "grasp.mp4"
                if not video.exists():
                    video = pathlib.Path(scratch) / f"{len(rows)}.mp4"
                    subprocess.run([options.program, "replay", folder, trial, "--video", str(video)], check=True)
                row = pathlib.Path(scratch) / f"{len(rows)}.png"
                inputs = [part for t in TIMES for part in ("-ss", str(t), "-i", str(video))]
                crop = "".join(f"[{i}:v]crop=iw/2:ih:iw/2:0,scale={WIDTH}:-1[p{i}];" for i in range(len(TIMES)))
                stack = "".join(f"[p{i}]" for i in range(len(TIMES))) + f"hstack={len(TIMES)}"
                subprocess.run(["ffmpeg", "-loglevel", "error", "-y", *inputs, "-filter_complex", crop + stack,
                                "-frames:v", "1", str(row)], check=True)
                rows.append(row)
        inputs = [part for row in rows for part in ("-i", str(row))]
        stack = ["-filter_complex", f"vstack={len(rows)}"] if len(rows) > 1 else []
        subprocess.run(["ffmpeg", "-loglevel", "error", "-y", *inputs, *stack, options.output], check=True)


if __name__ == "__main__":
    main()
