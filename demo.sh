#!/usr/bin/env bash
# Installs what is missing, builds, and renders the Cornell box through the SystemC model: out/ holds the result.
set -euo pipefail
cd "$(dirname "$0")"
source .ci/prepare.sh

prepare_build release csx600
print_time "Built"
mkdir -p out

echo "A short run with waves: out/cornell_box.vcd, open it with: gtkwave --save out/cornell_box.gtkw"
./build/release/csx600 render scenes/cornell_box --chip paper --size 64x64 --samples 1 \
  --waves out/cornell_box.vcd --waves-window 1700000:6000000 > /dev/null

echo "The Cornell box on the paper's chip: out/cornell_box.exr, .png, .json with the statistics, .html with both"
./build/release/csx600 render scenes/cornell_box --chip paper --samples 16 \
  --exr out/cornell_box.exr --png out/cornell_box.png --stats out/cornell_box.json
print_time "The picture, out/cornell_box.png"
./build/release/csx600 report out/cornell_box.json --image out/cornell_box.png -o out/cornell_box.html
