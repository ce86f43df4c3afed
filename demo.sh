#!/usr/bin/env bash
# Installs what is missing, builds, and renders the Cornell box through the SystemC model: out/ holds the result.
set -euo pipefail
cd "$(dirname "$0")"
source .ci/prepare.sh

prepare_build release csx600
mkdir -p out

echo "Rendering scenes/cornell_box at 480 x 480 on the model of the chip ..."
./build/release/csx600 render scenes/cornell_box --chip paper --samples 16 \
  --exr out/cornell_box.exr --png out/cornell_box.png --stats out/cornell_box.json

echo
echo "A short run with waves: out/cornell_box.vcd, view out/cornell_box.gtkw"
./build/release/csx600 render scenes/cornell_box --chip paper --size 64x64 --samples 1 \
  --vcd out/cornell_box.vcd --vcd-cycles 1700000:6000000 > /dev/null

echo "Written to out/:"
ls -lh out | awk 'NR > 1 { printf "  %-24s %s\n", $NF, $5 }'
