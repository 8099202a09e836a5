#!/bin/sh
# Build the fuzzer with clang, and write the files that it begins with: tests/fuzz/build.sh [BUILD] (default build-fuzz).
# Exit code 77: there is no clang-14 (or the compiler that CC names).
set -eu
build=${1:-build-fuzz}
compiler=${CC:-clang-14}
if ! command -v "$compiler" > /dev/null; then
  echo "fuzz: there is no $compiler; on Debian: apt-get install clang-14 libclang-rt-14-dev libomp-14-dev"
  exit 77
fi
root=$(cd "$(dirname "$0")/../.." && pwd)
cmake -S "$root" -B "$build" -DCMAKE_C_COMPILER="$compiler" -DEQUIMAP_FUZZ=ON -DEQUIMAP_TESTS=OFF -DEQUIMAP_PERF=OFF > /dev/null
cmake --build "$build" -j "${JOBS:-$(env -u OMP_NUM_THREADS nproc)}" --target fuzz seeds > /dev/null
mkdir -p "$build/seeds"
ASAN_OPTIONS=detect_leaks=0 "$build/tests/fuzz/seeds" "$build/seeds"
