#!/usr/bin/env bash
# Which lines of src/ the tests on one rank run: at night.
#   tests/coverage.sh [CTEST ARGUMENTS]     builds in build-coverage; the table is build-coverage/coverage.txt
# Needs gcovr (Debian: gcovr).
set -euo pipefail
cd "$(dirname "$0")/.."
if [ "$(id -u)" -eq 0 ]; then
  export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
fi
export OMP_NUM_THREADS=${OMP_NUM_THREADS:-1}
cmake -S . -B build-coverage -DCMAKE_BUILD_TYPE=Debug -DCMAKE_C_FLAGS='--coverage -O1 -fprofile-update=atomic' \
  -DEQUIMAP_TESTS=ON -DEQUIMAP_PERF=OFF
cmake --build build-coverage -j "$(nproc)"
find build-coverage -name '*.gcda' -delete
[ $# -gt 0 ] || set -- -R '^(unit|integration|verification|application|zoo|scans)\..*\.1$|^jobs\.' -LE 'nightly|perf'
ctest --test-dir build-coverage -j "$(nproc)" --timeout 3600 "$@" || echo "some tests fail; their lines count all the same" >&2
gcovr --root . --filter 'src/' --object-directory build-coverage build-coverage --txt build-coverage/coverage.txt
tail -n 4 build-coverage/coverage.txt
