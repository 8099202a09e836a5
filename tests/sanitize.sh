#!/usr/bin/env bash
# Unit and integration tests on one and two ranks under the address and undefined-behaviour sanitizers: at night.
#   tests/sanitize.sh [FOLDER [CTEST ARGUMENTS]]     default build-debug; e.g. tests/sanitize.sh build-debug -R format
set -euo pipefail
cd "$(dirname "$0")/.."
folder=${1:-build-debug}
[ $# -eq 0 ] || shift
if [ "$(id -u)" -eq 0 ]; then
  export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
fi
# Open MPI leaks on its own; an allocation that is refused is a case like another.
export ASAN_OPTIONS=detect_leaks=0:allocator_may_return_null=1 UBSAN_OPTIONS=print_stacktrace=1
cmake --preset debug -B "$folder"
cmake --build "$folder" -j "$(nproc)"
[ $# -gt 0 ] || set -- -R '^(unit|integration)\..*\.[12]$'
exec ctest --test-dir "$folder" --output-on-failure --timeout 3600 "$@"
