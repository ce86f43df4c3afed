#!/bin/sh
# Makes overlap.png: a fresh trace of one full cycle of the bins, opened by GTKWave with the view that lies beside it
# and not a click. Needs Debian's gtkwave, xvfb and imagemagick.
# usage: waves/screenshot.sh [CSX600]
set -eu
here=$(cd "$(dirname "$0")" && pwd)
program=$(realpath "${1:-$here/../build/release/csx600}")
directory=$(mktemp -d)
trap 'rm -rf "$directory"' EXIT

# 24 blocks: intersection stage, path stage and ray stage, 8 blocks each.
"$program" render "$here/../scenes/cornell_box" --size 64x64 --samples 1 \
  --waves "$directory/overlap.fst" --waves-blocks 97:24 > /dev/null

cat > "$directory/show.sh" <<'END'
gtkwave overlap.fst overlap.gtkw > gtkwave.log 2>&1 &
viewer=$!
sleep 8  # until it has drawn
import -window root overlap.png
kill "$viewer"
END
cd "$directory"
xvfb-run --auto-servernum --server-args "-screen 0 1500x940x24" sh show.sh
convert overlap.png -strip -colors 64 "$here/overlap.png"
