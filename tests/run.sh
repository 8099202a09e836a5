#!/usr/bin/env bash
# From a fresh Debian 12 to a verdict: install what is missing, build with warnings as errors, run the suite.
#   tests/run.sh [CTEST ARGUMENTS]     e.g. tests/run.sh -R domain; the default leaves out nightly and perf
# EQUIMAP_DATA may name a folder with real scans: the tests that reproduce published rows run then too.
set -euo pipefail
cd "$(dirname "$0")/.."
build=${EQUIMAP_BUILD:-build}
cores=$(env -u OMP_NUM_THREADS nproc)

[ -x jobs/setup.sh ] && jobs/setup.sh --tests

# Open MPI refuses root unless told twice.
if [ "$(id -u)" -eq 0 ]; then
  export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
fi
export OMP_NUM_THREADS=${OMP_NUM_THREADS:-1}

cmake -S . -B "$build" -DCMAKE_BUILD_TYPE=Release -DEQUIMAP_WERROR=ON -DEQUIMAP_TESTS=ON -DEQUIMAP_SANITIZE=ON
cmake --build "$build" -j "$cores"
[ $# -gt 0 ] || set -- -LE 'nightly|perf'
exec ctest --test-dir "$build" --output-on-failure -j "$cores" "$@"
