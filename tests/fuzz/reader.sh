#!/bin/sh
# Fuzz one reader with what tests/fuzz/build.sh has built: tests/fuzz/reader.sh SECONDS BUILD NAME. What the reader does not
# survive is left in BUILD/found/NAME-*, and the script then ends with 1; 77: nothing has been built.
set -eu
seconds=$1
build=$2
name=$3
if ! [ -x "$build/tests/fuzz/fuzz" ]; then
  echo "$name: there is no fuzzer in $build"
  exit 77
fi
mkdir -p "$build/seeds/$name" "$build/corpus/$name" "$build/found"
TMPDIR=$(mktemp -d)
export TMPDIR EQUIMAP_FUZZ="$name"
trap 'rm -rf "$TMPDIR"' EXIT
# MPI and libxml2 keep what they allocate once; readers' own memory is looked at by the unit tests
export ASAN_OPTIONS=detect_leaks=0:allocator_may_return_null=1
# Signals are the fuzzer's, which then saves the input: Open MPI takes none.
export OMPI_MCA_opal_signal=
# PETSc's reader of options does not give back what it has of a file that it refuses: programs of ten seconds.
most=300
[ "$name" = options ] && most=10
runs=0
for begin in $(seq 0 $most $((seconds - 1))); do
  left=$((seconds - begin))
  if ! "$build/tests/fuzz/fuzz" -max_total_time=$((left < most ? left : most)) -timeout=20 -rss_limit_mb=4096 -max_len=20000 -verbosity=0 \
      -print_final_stats=1 -artifact_prefix="$build/found/$name-" "$build/corpus/$name" "$build/seeds/$name" > "$build/$name.log" 2>&1; then
    tail -n 40 "$build/$name.log"
    echo "$name: FAILED, see $build/$name.log and $build/found/"
    exit 1
  fi
  runs=$((runs + $(sed -n 's/^stat::number_of_executed_units: *//p' "$build/$name.log")))
done
echo "$name: $runs runs"
