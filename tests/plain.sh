#!/usr/bin/env bash
# Unit and integration tests on one and two ranks without sanitizers, built anew as users' compilers do.
#   tests/plain.sh [FOLDER]     default build-plain
set -euo pipefail
cd "$(dirname "$0")/.."
folder=${1:-build-plain}
cores=$(env -u OMP_NUM_THREADS nproc)
if [ "$(id -u)" -eq 0 ]; then
  export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
fi
cmake -S . -B "$folder" -DCMAKE_BUILD_TYPE=Release -DEQUIMAP_WERROR=ON -DEQUIMAP_PERF=OFF -DEQUIMAP_SANITIZE=OFF > /dev/null
cmake --build "$folder" -j "$cores" > /dev/null
exec ctest --test-dir "$folder" -j "$cores" --no-tests=error --output-on-failure --timeout 3600 -R '^(unit|integration)\..*\.[12]$'
