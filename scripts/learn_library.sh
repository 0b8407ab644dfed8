#!/bin/sh
# Usage: scripts/learn_library.sh [SEED]
# Shows the four grasps of the paper to the robot's cameras, learns them and writes models/grasps.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
seed=${1:-1101}
program="$root/build/release/bin/springgrasp"
cd "$root"
out=out/library
mkdir -p "$out" models/grasps
for type in pinch tripod power lateral; do
  "$program" observe "scenes/show_$type.yaml" -o "$out/$type.csv" --truth "$out/$type.truth.csv" --seed "$seed"
  "$program" learn "$out/$type.csv" --type "$type" -o "$out/$type.yaml" | tee "$out/$type.txt"
done
# All four or none.
for type in pinch tripod power lateral; do cp "$out/$type.yaml" "models/grasps/$type.yaml"; done
"$program" library models/grasps
