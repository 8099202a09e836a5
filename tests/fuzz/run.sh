#!/bin/sh
# Fuzz every reader: tests/fuzz/run.sh SECONDS [BUILD] [NAME...]. Seconds are for each reader; BUILD (default build-fuzz) is
# made with clang; NAMEs choose readers (default: all). What a reader does not survive is left in BUILD/found/NAME-*, and
# the script then ends with 1.
set -eu
seconds=$1
build=${2:-build-fuzz}
[ $# -lt 2 ] && shift 1 || shift 2
root=$(cd "$(dirname "$0")/../.." && pwd)
cmake -S "$root" -B "$build" -DCMAKE_C_COMPILER="${CC:-clang-14}" -DEQUIMAP_FUZZ=ON -DEQUIMAP_TESTS=OFF -DEQUIMAP_PERF=OFF > /dev/null
names=${*:-ply vtu gii vtk white msh mesh meshb off stl node obj points hdf5 xdmf density table options}
targets=seeds
for name in $names; do targets="$targets fuzz_$name"; done
cmake --build "$build" -j "${JOBS:-2}" --target $targets >> /dev/null
mkdir -p "$build/seeds" "$build/corpus" "$build/found" "$build/tmp"
TMPDIR=$(cd "$build/tmp" && pwd)
export TMPDIR
trap 'rm -rf "$TMPDIR"' EXIT
# MPI and libxml2 keep what they allocate once; readers' own memory is looked at by the unit tests
export ASAN_OPTIONS=detect_leaks=0:allocator_may_return_null=1 OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
"$build/tests/fuzz/seeds" "$build/seeds"
failed=0
for name in $names; do
  mkdir -p "$build/seeds/$name" "$build/corpus/$name"
  if "$build/tests/fuzz/fuzz_$name" -max_total_time="$seconds" -timeout=20 -rss_limit_mb=2048 -max_len=16384 -verbosity=0 \
      -print_final_stats=1 -artifact_prefix="$build/found/$name-" "$build/corpus/$name" "$build/seeds/$name" > "$build/$name.log" 2>&1; then
    echo "$name: $(sed -n 's/^stat::number_of_executed_units: */runs: /p' "$build/$name.log")"
  else
    echo "$name: FAILED, see $build/$name.log and $build/found/"
    failed=1
  fi
done
exit $failed
