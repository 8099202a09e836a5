#!/usr/bin/env bash
# The program on a PETSc with 64-bit indices: the preset int64 is built in a folder of its own, without a warning, and its
# unit and integration tests run on one and two ranks, those of the program on one.
#   tests/int64.sh [FOLDER]     default build-int64; EQUIMAP_JOBS: how many at a time (the number of cores)
# Exit code 77 where that PETSc is missing; on Debian: apt-get install libpetsc64-real-dev libslepc64-real-dev
set -euo pipefail
cd "$(dirname "$0")/.."
folder=${1:-build-int64}
jobs=${EQUIMAP_JOBS:-$(env -u OMP_NUM_THREADS nproc)}
if ! pkg-config --exists PETSc64; then
  echo "int64: there is no PETSc64; on Debian: apt-get install libpetsc64-real-dev libslepc64-real-dev"
  exit 77
fi
if [ "$(id -u)" -eq 0 ]; then
  export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
fi
export OMP_NUM_THREADS=${OMP_NUM_THREADS:-1}

cmake --preset int64 -B "$folder"
cmake --build "$folder" -j "$jobs"
ctest --test-dir "$folder" --output-on-failure -j "$jobs" -LE 'nightly|perf' -R '^(unit|integration)\.test_.*\.[12]$|^application\.test_.*\.1$'
