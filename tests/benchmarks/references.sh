#!/bin/sh
# Makes the references of the shipped scenes again, which `csx600 bench error` compares with. Each is checked against a
# second estimator. Usage: tests/benchmarks/references.sh [CSX600 [SCENE...]]
set -eu
cd "$(dirname "$0")/../.."

# The scenes that have one. To add a scene: its name.
scenes="cornell_box glossy glass environment many_lights textured outdoors"

csx600=${1:-build/release/csx600}
[ $# -lt 2 ] || { shift; scenes=$*; }
for scene in $scenes; do
  "$csx600" bench reference "scenes/$scene" --size 48x48 --samples 16384 --check-samples 16384 \
    -o "scenes/$scene/reference.exr"
done
