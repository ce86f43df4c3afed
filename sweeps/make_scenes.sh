#!/usr/bin/env bash
# Generates the scenes that the sweeps of the tree use, into out/scenes. From the project's root.
set -euo pipefail
csx600=${CSX600:-build/release/csx600}

make_scene() {  # kind triangles name
  [ -f "out/scenes/$3/scene.toml" ] || "$csx600" scene "$1" --triangles "$2" -o "out/scenes/$3"
}

mkdir -p out/scenes
make_scene blob 100 blob_100
make_scene blob 1000 blob_1k
make_scene blob 10000 blob_10k
make_scene blob 100000 blob_100k
make_scene blob 1000000 blob_1m
make_scene sphere_flake 100000 sphere_flake_100k
make_scene stadium 100000 stadium_100k
make_scene needles 10000 needles_10k
