#!/usr/bin/env bash
# From a fresh Debian 12 to a picture: install what is missing, build, map a real scan to the disk, draw the result.
#   jobs/demo.sh             needs root or sudo only while packages are missing; a second run takes seconds
# Everything it makes lies in build/ and build/demo/.
set -euo pipefail
cd "$(dirname "$0")/.."
demo=build/demo
ranks=${EQUIMAP_DEMO_RANKS:-2}

say() { echo "demo: $*"; }
# Run a step quietly; when it fails, show the end of what it said.
quietly() {
  local log=$demo/log.txt
  "$@" >"$log" 2>&1 && return 0
  local code=$?
  tail -n 20 "$log" | cut -c1-300 >&2
  say "failed: $*" >&2
  return $code
}

jobs/setup.sh
mkdir -p "$demo"

say "building"
[ -f build/CMakeCache.txt ] || quietly cmake -S . -B build -DCMAKE_BUILD_TYPE=Release
quietly cmake --build build -j "$(env -u OMP_NUM_THREADS nproc)" --target equimap

# A scanned mask from a Debian package that is unpacked here, not installed.
scan=$demo/mannequin-devil.off
get_scan() {
  local folder=$demo/package
  mkdir -p "$folder"
  (cd "$folder" && apt-get download libcgal-demo && dpkg -x libcgal-demo_*.deb .) >"$demo/log.txt" 2>&1 || return 1
  tar -xzOf "$folder/usr/share/doc/libcgal-dev/data.tar.gz" data/meshes/mannequin-devil.off >"$scan.part" 2>>"$demo/log.txt" || return 1
  mv "$scan.part" "$scan"
  rm -rf "$folder"
}
mesh=$scan
if [ ! -s "$scan" ]; then
  say "fetching a scan (Debian package libcgal-demo)"
  if ! get_scan; then
    rm -rf "$demo/package" "$scan.part"
    mesh=$demo/hills.obj
    say "the scan cannot be had; taking a generated surface instead"
    quietly build/equimap generate hills -n 20000 -o "$mesh"
  fi
fi

# Open MPI refuses root unless told twice, and binds each rank to one core unless told not to.
if [ "$(id -u)" -eq 0 ]; then
  export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
fi
say "mapping $(basename "$mesh") to the disk on $ranks ranks"
code=0
OMP_NUM_THREADS=${OMP_NUM_THREADS:-1} mpirun -n "$ranks" --oversubscribe --bind-to none --mca mpi_yield_when_idle 1 \
  build/equimap disk "$mesh" -o "$demo/result.h5" -summary "$demo/summary.json" -history "$demo/history.csv" \
  >"$demo/log.txt" 2>&1 || code=$?
case $code in
  0 | 4 | 5) ;; # 4: not converged, 5: folds remain; the map is there
  *) tail -n 20 "$demo/log.txt" | cut -c1-300 >&2; say "equimap ended with exit code $code" >&2; exit "$code" ;;
esac
quietly build/equimap report "$demo/result.h5" -o "$demo/result.png"

python3 - "$demo/summary.json" <<'END'
import json, sys

summary = json.load(open(sys.argv[1]))
ratio = summary["ratio_weighted"]
slivers = []
if ratio["outliers"]:
    slivers = [("slivers", f"{ratio['outliers']:,} triangles, {100 * ratio['outlier_share']:.2g} % of the area, are off by more than 10 SD"),
               ("SD over triangles", f"{summary['ratio']['sd']:.4g}; {ratio['cell_sd_without_outliers']:.4g} without these")]
rows = [
    ("vertices", f"{summary['mesh']['vertices']:,}"),
    ("triangles", f"{summary['mesh']['cells']:,}"),
    ("method", summary["method"]),
    ("status", summary["status"]),
    ("energy E", f"{summary['energy']['initial']:.4g} -> {summary['energy']['final']:.4g}"),
    ("SD of area ratio", f"{ratio['sd']:.4g} by area; 90 % of the area from {ratio['p05']:.6g} to {ratio['p95']:.6g}"),
    *slivers,
    ("folds", f"{summary['folds']}"),
    ("iterations", f"{summary['iterations']}"),
    ("seconds", f"{summary['seconds']['total']:.2f}"),
]
print()
for name, value in rows:
    print(f"  {name:<18} {value}")
print()
END
say "picture: $PWD/$demo/result.png   data: $PWD/$demo/result.h5"
