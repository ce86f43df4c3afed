# Sourced by demo.sh, test.sh and .ci/style, from the project's root.

# Debian 12 packages. The CMake files that use them say what for; python3 runs .ci/layers.
packages=(
  g++ cmake ninja-build pkg-config binutils
  libsystemc-dev libglm-dev libopenexr-dev libpng-dev libjpeg-dev libssl-dev
  libsleef-dev librandom123-dev libglu1-mesa-dev libmeshoptimizer-dev libdraco-dev libembree-dev
  libcli11-dev libtomlplusplus-dev nlohmann-json3-dev libmuparser-dev libpugixml-dev
  libgtest-dev libbenchmark-dev
  libopenmpi-dev openmpi-bin gtkwave chromium python3
)

install_missing_packages() {
  local missing=()
  local package
  for package in "${packages[@]}"; do
    dpkg-query -W -f='${Status}' "$package" 2> /dev/null | grep -q 'ok installed' || missing+=("$package")
  done
  [ "${#missing[@]}" -eq 0 ] && return
  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo > /dev/null || {
      echo "missing packages: ${missing[*]}; install them as root, or install sudo" >&2
      exit 1
    }
    as_root=(sudo)
  fi
  echo "Installing with apt: ${missing[*]}"
  "${as_root[@]}" apt-get update -qq
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" \
    > /dev/null
}

# prepare_build PRESET TARGET...: packages, configuration, build. Quick when nothing changed. The environment's CSX600_LEVELS
# says which levels of x86-64 kernels are built for (firmware/levels.cmake).
prepare_build() {
  install_missing_packages
  [ -f "build/$1/build.ninja" ] || cmake --preset "$1" ${CSX600_LEVELS:+-DCSX600_LEVELS="$CSX600_LEVELS"} > /dev/null
  cmake --build --preset "$1" --target "${@:2}"
}

# print_time WHAT: prints the time since the script began.
print_time() {
  printf '%s: %d min %02d s since the start\n' "$1" $((SECONDS / 60)) $((SECONDS % 60))
}
