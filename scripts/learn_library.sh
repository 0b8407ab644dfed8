#!/bin/sh
# Usage: scripts/learn_library.sh [SEED]
# Shows the four grasps of the paper to the robot's cameras, learns them, and writes models/grasps:
# TYPE.csv as tracked, TYPE.yaml as learned from it.
set -eu
cd "$(dirname "$0")/.."
seed=${1:-1101}
program=build/release/bin/springgrasp
out=out/library
mkdir -p "$out" models/grasps
for type in pinch tripod power lateral; do
  "$program" observe "scenes/show_$type.yaml" -o "$out/$type.csv" --truth "$out/$type.truth.csv" --seed "$seed"
done
# The tripod from the side, of scenes/tripod_side.yaml; not one of the paper's four.
"$program" observe scenes/tripod_side.yaml -o "$out/side_tripod.csv" --seed "$seed"
# All or none.
for type in pinch tripod power lateral; do cp "$out/$type.csv" "models/grasps/$type.csv"; done
for type in pinch tripod power lateral; do
  "$program" learn "models/grasps/$type.csv" --type "$type" -o "models/grasps/$type.yaml" | tee "$out/$type.txt"
done
mkdir -p models/grasps/side
cp "$out/side_tripod.csv" models/grasps/side/tripod.csv
"$program" learn models/grasps/side/tripod.csv --type tripod -o models/grasps/side/tripod.yaml | tee "$out/side_tripod.txt"
"$program" library models/grasps
