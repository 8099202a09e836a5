#!/usr/bin/env bash
# Which lines of src/ the tests on one rank run: at night.
#   tests/coverage.sh [FOLDER [CTEST ARGUMENTS]]     default build-coverage; the table is FOLDER/coverage.txt
# Needs gcovr (Debian: gcovr).
set -euo pipefail
cd "$(dirname "$0")/.."
folder=${1:-build-coverage}
[ $# -eq 0 ] || shift
if [ "$(id -u)" -eq 0 ]; then
  export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
fi
export OMP_NUM_THREADS=${OMP_NUM_THREADS:-1}
cmake -S . -B "$folder" -DCMAKE_BUILD_TYPE=Debug -DCMAKE_C_FLAGS='--coverage -O1 -fprofile-update=atomic' \
  -DEQUIMAP_TESTS=ON -DEQUIMAP_PERF=OFF
cmake --build "$folder" -j "$(env -u OMP_NUM_THREADS nproc)"
find "$folder" -name '*.gcda' -delete
[ $# -gt 0 ] || set -- -R '^(unit|integration|verification|application|zoo|scans)\..*\.1$|^jobs\.' -LE 'nightly|perf'
ctest --test-dir "$folder" -j "$(env -u OMP_NUM_THREADS nproc)" --timeout 3600 "$@" || echo "some tests fail; their lines count all the same" >&2
# gcov prints a negative count where a process was killed while it wrote its own.
gcovr --gcov-ignore-parse-errors --root . --filter 'src/' --object-directory "$folder" "$folder" --txt "$folder/coverage.txt"
tail -n 4 "$folder/coverage.txt"
