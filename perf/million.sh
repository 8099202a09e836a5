#!/usr/bin/env bash
# A surface of a million vertices to the disk: where the seconds and the bytes go.
#   perf/million.sh [PROGRAM [FOLDER [OPTIONS...]]]     e.g. perf/million.sh build/equimap /scratch -max_it 20
# The mesh is made once and kept in FOLDER (default: perf-million beside the program), with the summary and the history.
# EQUIMAP_VERTICES, EQUIMAP_RANKS and OMP_NUM_THREADS change the size (1000000), the ranks (2) and the threads of each (1).
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
program=${1:-$here/../build/equimap}
folder=${2:-$(dirname "$program")/perf-million}
shift $(($# < 2 ? $# : 2))
vertices=${EQUIMAP_VERTICES:-1000000}
ranks=${EQUIMAP_RANKS:-2}
export OMP_NUM_THREADS=${OMP_NUM_THREADS:-1}
# Open MPI refuses root unless told twice, and binds each rank to one core unless told not to.
if [ "$(id -u)" -eq 0 ]; then
  export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
fi

mkdir -p "$folder"
mesh=$folder/hills-$vertices.h5
if [ ! -s "$mesh" ]; then
  echo "generating $mesh"
  "$program" generate hills -n "$vertices" -o "$folder/part-hills-$vertices.h5"
  mv "$folder/part-hills-$vertices.h5" "$mesh"
fi

result=$folder/result-$vertices
code=0
echo "load before the run: $(cut -d' ' -f1-3 /proc/loadavg) on $(nproc --all) cores"
mpirun -n "$ranks" --oversubscribe --bind-to none --mca mpi_yield_when_idle 1 \
  "$program" disk "$mesh" -o "$result.h5" -summary "$result.json" -history "$result.csv" -max_it 6 "$@" || code=$?
echo "load after the run: $(cut -d' ' -f1-3 /proc/loadavg)"
case $code in
  0 | 4 | 5) ;; # 4: not converged, which six iterations are not meant to; 5: folds remain; the map is there
  *) echo "equimap ended with exit code $code" >&2; exit "$code" ;;
esac
exec /usr/bin/env python3 "$here/shares.py" "$result.json"
