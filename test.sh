#!/usr/bin/env bash
# Installs what is missing, builds, and runs the tests. Arguments go to ctest: ./test.sh -R film
set -euo pipefail
cd "$(dirname "$0")"
source .ci/prepare.sh

prepare_build release all
print_time "Built"
trap 'print_time "Tests"' EXIT
ctest --preset release --parallel "$(nproc)" "$@"
