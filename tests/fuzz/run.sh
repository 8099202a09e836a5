#!/bin/sh
# Build the fuzzer and fuzz every reader: tests/fuzz/run.sh SECONDS [BUILD] [NAME...]. Seconds are for each reader; BUILD
# (default build-fuzz) is made with clang; NAMEs choose readers (default: all of tests/fuzz/readers.txt); JOBS: how many at
# a time (the number of cores).
set -eu
seconds=$1
build=${2:-build-fuzz}
[ $# -lt 2 ] && shift 1 || shift 2
here=$(dirname "$0")
"$here/build.sh" "$build"
[ $# -gt 0 ] || set -- $(cat "$here/readers.txt")
printf '%s\n' "$@" | xargs -P "${JOBS:-$(env -u OMP_NUM_THREADS nproc)}" -n 1 "$here/reader.sh" "$seconds" "$build"
