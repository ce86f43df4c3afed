#!/usr/bin/env bash
# The same bits, whatever builds and runs the program. Each build renders the Cornell box in several ways; all images must be
# equal, and the statistics of one way must be equal across builds and levels, but for what the simulator took.
# Usage: tests/determinism.sh [BUILD...]
#   BUILD is COMPILER:OPTIMISATION (g++:-O3), COMPILER:OPTIMISATION:no-mpi, or release, which is build/release as it is.
#   Without arguments: release. The first one is the reference.
# CSX600_LEVELS (default native) says which x86-64 levels are built; each that this machine executes is run.
# With qemu-x86_64 (Debian: qemu-user) levels v2 and v3 run on emulated arithmetic, too; QEMU 7.2 has no AVX-512 for v4.
# Exit code: 0 all equal, 1 something differs or failed, 2 wrong usage.
set -euo pipefail
cd "$(dirname "$0")/.."
[ $# -gt 0 ] || set -- release
levels=${CSX600_LEVELS:-native}
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

build() {  # BUILD: sets program
  if [ "$1" = release ]; then
    program=build/release/csx600
  elif [[ $1 =~ ^([a-z0-9+.-]+):(-O[0-3])(:no-mpi)?$ ]]; then
    local folder=build/determinism/${1//:/}
    local options=()
    [ -z "${BASH_REMATCH[3]}" ] || options+=(-DCMAKE_DISABLE_FIND_PACKAGE_MPI=ON)
    # Other compilers and optimisations warn of other things; what they compute is looked at here.
    cmake -G Ninja -S . -B "$folder" -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER="${BASH_REMATCH[1]}" \
      -DCMAKE_CXX_FLAGS_RELEASE="${BASH_REMATCH[2]} -DNDEBUG" -DCSX600_LEVELS="$levels" -DCSX600_TESTS=OFF \
      -DCSX600_WARNINGS_AS_ERRORS=OFF "${options[@]}" > "$work/log" 2>&1 &&
      cmake --build "$folder" --target csx600 >> "$work/log" 2>&1 || {
      tail -n 20 "$work/log" >&2
      echo "determinism: $1 does not build" >&2
      exit 1
    }
    program=$folder/csx600
  else
    echo "determinism: found build '$1', must be release or COMPILER:-O0..-O3[:no-mpi]" >&2
    exit 2
  fi
  [ -x "$program" ] || {
    echo "determinism: $program is missing: build preset release first" >&2
    exit 2
  }
}

differing=0
declare -A expected
check() {  # KIND VALUE: sets verdict
  : "${expected[$1]:=$2}"
  [ "${expected[$1]}" = "$2" ] || { verdict=DIFFERS; differing=$((differing + 1)); }
}

run() {  # BUILD WAY LEVEL RENDER_OPTIONS...; launcher is what starts the program
  local verdict=equal
  if ! "${launcher[@]}" "$program" render scenes/cornell_box --size 24x24 --samples 2 --level "$3" "${@:4}" \
    --stats "$work/run.json" > "$work/log" 2>&1; then
    tail -n 3 "$work/log" >&2
    verdict=FAILED differing=$((differing + 1))
    printf '%-18s %-12s %-6s %s\n' "$1" "$2" "$3" "$verdict"
    return
  fi
  local image statistics
  read -r image statistics < <(python3 - "$work/run.json" << 'PYTHON'
import hashlib, json, sys

def without_simulator(value):
    if isinstance(value, dict):
        return {key: without_simulator(inner) for key, inner in value.items() if key != "simulator"}
    return [without_simulator(inner) for inner in value] if isinstance(value, list) else value

statistics = json.load(open(sys.argv[1]))
print(statistics["image_sha256"], hashlib.sha256(json.dumps(without_simulator(statistics)).encode()).hexdigest())
PYTHON
)
  check image "$image"
  check "statistics of $2" "$statistics"
  printf '%-18s %-12s %-6s %.12s  %.12s  %s\n' "$1" "$2" "$3" "$image" "$statistics" "$verdict"
}

printf '%-18s %-12s %-6s %-12s  %-12s\n' build way level image statistics
for name in "$@"; do
  build "$name"
  launcher=(env)
  run "$name" lt auto
  run "$name" at auto --timing at
  run "$name" native auto --native
  for n in 0 3 6; do run "$name" "n=$n" auto --n "$n"; done
  for pes in 32 64; do run "$name" "pes=$pes" auto --set "chip.pes=$pes"; done
  for level in v2 v3 v4; do
    "$program" render scenes/cornell_box --size 1x1 --samples 1 --native --level $level > /dev/null 2>&1 || continue
    run "$name" lt $level
    if [ $level != v4 ] && command -v qemu-x86_64 > /dev/null; then
      launcher=(qemu-x86_64 -cpu max)
      run "$name (QEMU)" lt $level
      launcher=(env)
    fi
  done
  if [[ $name != *:no-mpi ]] && command -v mpirun > /dev/null; then
    launcher=(mpirun --oversubscribe -np 2)
    run "$name" ranks=2 auto
  fi
done
[ $differing = 0 ] || {
  echo "determinism: $differing values differ or runs failed" >&2
  exit 1
}
