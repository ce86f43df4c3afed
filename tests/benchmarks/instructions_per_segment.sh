#!/usr/bin/env bash
# Host instructions a path segment, with timing: the same on every run, however busy the machine is.
#   tests/benchmarks/instructions_per_segment.sh [CSX600 [LEVEL]]
# Two renders of different length are counted and subtracted, so that start-up does not count. Valgrind executes
# x86-64-v3 at most.
set -euo pipefail
cd "$(dirname "$0")/../.."
binary=${1:-build/release/csx600}
level=${2:-v3}
command -v valgrind > /dev/null || { echo "instructions_per_segment.sh: needs valgrind" >&2; exit 2; }
[ -x "$binary" ] || { echo "instructions_per_segment.sh: found no program $binary; build target csx600" >&2; exit 2; }
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# count PROGRAM SAMPLES: instructions and segments of one render.
count() {
  valgrind --tool=callgrind --callgrind-out-file="$scratch/profile" "$binary" render scenes/cornell_box --chip paper \
    --size 96x96 --samples "$2" --program "$1" --level "$level" > "$scratch/out" 2> "$scratch/err" ||
    { cat "$scratch/out" "$scratch/err" >&2; exit 1; }
  awk '/^summary:|^totals:/ { instructions = $2 } END { printf "%s ", instructions }' "$scratch/profile"
  awk '/path segments/ { print $3 }' "$scratch/out"
}

printf '%-10s %24s\n' program "instructions a segment"
for program in segments direct full; do
  read -r short_instructions short_segments <<< "$(count "$program" 1)"
  read -r long_instructions long_segments <<< "$(count "$program" 4)"
  printf '%-10s %24d\n' "$program" \
    $(((long_instructions - short_instructions) / (long_segments - short_segments)))
done
