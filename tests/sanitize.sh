#!/usr/bin/env bash
# Tests on one and two ranks under the address and undefined-behaviour sanitizers.
#   tests/sanitize.sh [FOLDER [part | CTEST ARGUMENTS]]     default build-debug; e.g. tests/sanitize.sh build-debug -R format
# Without arguments unit and integration tests; `part`: what has pointers into files, into other ranks and into memory of
# its own, two minutes on two cores. Both at night.
set -euo pipefail
cd "$(dirname "$0")/.."
folder=${1:-build-debug}
[ $# -eq 0 ] || shift
if [ "$(id -u)" -eq 0 ]; then
  export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
fi
# Open MPI leaks on its own; an allocation that is refused is a case like another.
export ASAN_OPTIONS=detect_leaks=0:allocator_may_return_null=1 UBSAN_OPTIONS=print_stacktrace=1
part=(test_format test_format_faces test_exchange test_state test_store test_narrow test_mesh test_hierarchy test_diagnose test_lm test_solid)
cmake --preset debug -B "$folder" > /dev/null
if [ "${1:-}" = part ]; then
  cmake --build "$folder" -j "$(nproc)" --target "${part[@]}" > /dev/null
  set -- -R "^unit\.($(IFS='|' && echo "${part[*]}"))\.[12]$"
else
  cmake --build "$folder" -j "$(nproc)"
  [ $# -gt 0 ] || set -- -R '^(unit|integration)\..*\.[12]$'
fi
exec ctest --test-dir "$folder" -j "$(nproc)" --no-tests=error --output-on-failure --timeout 3600 "$@"
