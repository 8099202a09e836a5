#!/usr/bin/env bash
# Do threads race? The kernels' tests, on one rank and three threads, under clang's ThreadSanitizer, with LLVM's OpenMP and
# its library Archer, which tells the sanitizer of barriers, tasks and reductions. A race that is planted has to be found
# first.
#   tests/threads.sh [FOLDER]     default build-threads
# Exit code 77: there is no clang-14 or no Archer; on Debian: apt-get install clang-14 libclang-rt-14-dev libomp-14-dev
set -euo pipefail
cd "$(dirname "$0")/.."
folder=${1:-build-threads}
compiler=${CC:-clang-14}
archer=$(ls /usr/lib/llvm-*/lib/libarcher.so 2>/dev/null | head -n 1 || true)
if ! command -v "$compiler" > /dev/null || [ -z "$archer" ]; then
  echo "threads: there is no $compiler, or no libarcher.so; on Debian: apt-get install clang-14 libclang-rt-14-dev libomp-14-dev"
  exit 77
fi
cores=$(env -u OMP_NUM_THREADS nproc)
if [ "$(id -u)" -eq 0 ]; then
  export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
fi
tests=(test_threads test_energy test_hessian test_terms test_fronts test_linalg test_locate test_onlevels test_cascade)
cmake -S . -B "$folder" -DCMAKE_C_COMPILER="$compiler" -DCMAKE_BUILD_TYPE=Debug -DCMAKE_C_FLAGS='-O1 -g1 -fsanitize=thread' \
  -DEQUIMAP_PERF=OFF > /dev/null
cmake --build "$folder" -j "$cores" --target "${tests[@]}" > /dev/null
# Libraries without the sanitizer (PETSc, MPI, BLAS) are left out of account.
export OMP_TOOL_LIBRARIES=$archer OMP_NUM_THREADS=3 KMP_BLOCKTIME=0
export TSAN_OPTIONS=ignore_noninstrumented_modules=1:history_size=7:exitcode=66:suppressions=$PWD/tests/support/threads.supp

printf '%s\n' 'int main(void) {' '  int sum = 0;' '#pragma omp parallel for' '  for (int i = 0; i < 100000; i++) sum += i;' '  return sum == 1;' '}' > "$folder/planted.c"
"$compiler" -O1 -g1 -fopenmp -fsanitize=thread "$folder/planted.c" -o "$folder/planted"
if "$folder/planted" > "$folder/planted.log" 2>&1; then
  echo "threads: the planted race is not found"
  exit 1
fi
failed=0
for test in "${tests[@]}"; do
  if "$folder/tests/$test" > "$folder/$test.log" 2>&1; then
    echo "$test: no race"
  else
    grep -A 12 -m 3 'WARNING: ThreadSanitizer' "$folder/$test.log" || tail -n 5 "$folder/$test.log"
    echo "$test: FAILED, see $folder/$test.log"
    failed=1
  fi
done
exit $failed
