#!/usr/bin/env bash
# Tests of the program under the address and undefined-behaviour sanitizers; unit and integration tests are under them in
# every run of tests/run.sh.
#   tests/sanitize.sh [FOLDER [CTEST ARGUMENTS]]     default build-debug; e.g. tests/sanitize.sh build-debug -R format
# Without arguments: what reads the files and options of strangers, and what prepares their meshes.
set -euo pipefail
cd "$(dirname "$0")/.."
folder=${1:-build-debug}
[ $# -eq 0 ] || shift
cores=$(env -u OMP_NUM_THREADS nproc)
if [ "$(id -u)" -eq 0 ]; then
  export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
fi
cmake --preset debug -B "$folder" > /dev/null
cmake --build "$folder" -j "$cores"
[ $# -gt 0 ] || set -- -R '^application\.test_(bad_input|reading|options|presets|output|prepare|fields|resample)\.[12]$'
exec ctest --test-dir "$folder" -j "$cores" --no-tests=error --output-on-failure --timeout 3600 "$@"
