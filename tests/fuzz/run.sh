#!/usr/bin/env bash
# Fuzzes readers one after the other, each for SECONDS, and prints a table. What is found stays in out/fuzz/findings/TARGET,
# what covered more than the committed inputs in out/fuzz/corpus/TARGET, where the next run goes on. Exit code 1: findings.
#
#     tests/fuzz/run.sh SECONDS [TARGET...]
#
# CSX600_FUZZ_SEED: the seed of libFuzzer's inputs, which then come in the same order each time; without it one of its own.
set -euo pipefail
cd "$(dirname "$0")/../.."
here=tests/fuzz
fuzz_readers=build/fuzz/fuzz_readers
seconds=${1:-}
[[ $seconds =~ ^[1-9][0-9]*$ ]] || {
  echo "$here/run.sh: found '$seconds' as the first argument; allowed: a number of seconds, then targets" >&2
  exit 2
}
[ -x $fuzz_readers ] || {
  echo "$fuzz_readers: found no such program; allowed: what cmake --preset fuzz && cmake --build --preset fuzz make" >&2
  exit 2
}
shift
targets=("$@")
[ $# -gt 0 ] || mapfile -t targets < <(ls $here/corpus)

# A large allocation, a slow input and a leak are findings as well. AddressSanitizer keeps little of what was freed, so that
# the limit of memory is the reader's.
# The readers' directory is a temporary one, so paths for libFuzzer are absolute.
output=$PWD/out/fuzz
export TMPDIR=$output/temporary
rm -rf "$TMPDIR"
mkdir -p "$TMPDIR"
touch "$output/start"
export ASAN_OPTIONS=quarantine_size_mb=16:${ASAN_OPTIONS:-}
seed=${CSX600_FUZZ_SEED:-0}  # 0: libFuzzer's choice
limits=(-seed="$seed" -timeout=10 -report_slow_units=60 -malloc_limit_mb=512 -rss_limit_mb=1024)

# number_behind WORDS FILE: the last number that follows these words; 0 without one.
number_behind() {
  sed -n "s/.*$1 *\([0-9][0-9]*\).*/\1/p" "$2" | tail -1 | grep . || echo 0
}

# fuzz TARGET: goes on after a finding, until its time is over. Adds up in executions, coverage.
fuzz() {
  local target=$1 end=$((SECONDS + seconds)) log=$output/$1.log options=()
  mkdir -p "$output/corpus/$target" "$output/findings/$target"
  [ ! -f "$here/dictionaries/$target.dict" ] || options=(-dict="$here/dictionaries/$target.dict")
  executions=0
  coverage=0
  while [ $SECONDS -lt $end ]; do
    $fuzz_readers --target="$target" "${limits[@]}" "${options[@]}" -max_total_time=$((end - SECONDS)) \
      -print_final_stats=1 -artifact_prefix="$output/findings/$target/" "$output/corpus/$target" "$here/corpus/$target" > "$log" 2>&1 ||
      sed -n '/ERROR/,$p' "$log" >> "$output/findings/$target.log"
    executions=$((executions + $(number_behind number_of_executed_units: "$log")))
    coverage=$(number_behind cov: "$log")
  done
}

all_findings=0
printf '%-14s %11s %8s %9s %9s\n' target executions exec/s coverage findings
for target in "${targets[@]}"; do
  fuzz "$target"
  findings=$(find "$output/findings/$target" -type f -newer "$output/start" | wc -l)
  all_findings=$((all_findings + findings))
  printf '%-14s %11d %8d %9d %9d\n' "$target" "$executions" $((executions / seconds)) "$coverage" "$findings"
done
[ $all_findings -eq 0 ]
