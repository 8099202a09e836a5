#!/usr/bin/env bash
# Install a build, then build a small program against the installed tree twice, with find_package and with pkg-config, and
# run both. The library's own folders must not be needed.
#   tests/consumer/run.sh BUILD_FOLDER
set -euo pipefail
source_folder=$(cd "$(dirname "$0")" && pwd)
build=$(cd "${1:?usage: tests/consumer/run.sh BUILD_FOLDER}" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
if [ "$(id -u)" -eq 0 ]; then
  export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
fi
launcher=${EQUIMAP_TEST_MPIEXEC:-mpiexec -n %n}
# shellcheck disable=SC2086 # the launcher is words
run() { ${launcher//%n/2} "$@"; }

# Installed elsewhere than the build was configured for: both ways to find it must move along.
cmake --install "$build" --prefix "$work/installed" >"$work/install.log" || { cat "$work/install.log"; exit 1; }
installed=$work/installed
"$installed/bin/equimap" --version
for page in share/man/man1/equimap.1 share/man/man1/equimap-disk.1 share/bash-completion/completions/equimap; do
  [ -s "$installed/$page" ] || { echo "$page is not installed"; exit 1; }
done

# The module, where Environment Modules are: program, pages (its own and those of the system), library, Python package.
if [ -r /usr/share/modules/init/bash ]; then
  (
    set +eu
    # shellcheck source=/dev/null
    . /usr/share/modules/init/bash
    module use "$installed/share/modulefiles"
    module load equimap
    if ! { [ "$(command -v equimap)" -ef "$installed/bin/equimap" ] && [[ $MANPATH == "$installed/share/man:"* ]] && [[ ":$MANPATH:" == *::* ]] &&
           [ "$(pkg-config --variable=prefix equimap)" -ef "$installed" ] && [[ $PYTHONPATH == "$installed/share/equimap/python"* ]]; }; then
      echo "the module sets PATH $PATH, MANPATH $MANPATH, PKG_CONFIG_PATH $PKG_CONFIG_PATH, PYTHONPATH $PYTHONPATH"
      exit 1
    fi
    module unload equimap
    [ -z "$EQUIMAP" ] || { echo "the module leaves EQUIMAP=$EQUIMAP behind"; exit 1; }
    echo "module: loaded and unloaded"
  )
else
  echo "module: not tried, there are no Environment Modules here"
fi

cmake -S "$source_folder" -B "$work/cmake" -DCMAKE_PREFIX_PATH="$installed" >"$work/cmake.log" || { cat "$work/cmake.log"; exit 1; }
cmake --build "$work/cmake" >"$work/make.log" || { cat "$work/make.log"; exit 1; }
echo "find_package:"
run "$work/cmake/consumer"

pc=$(dirname "$(find "$installed" -name equimap.pc)")
export PKG_CONFIG_PATH=$pc${PKG_CONFIG_PATH:+:$PKG_CONFIG_PATH}
flags=$(pkg-config --cflags --libs equimap)
# shellcheck disable=SC2086 # flags are words
mpicc -std=c11 -o "$work/consumer" "$source_folder/main.c" $flags
echo "pkg-config:"
run "$work/consumer"

# The programs of docs/library.md: the first makes the same map as the program, to the last bit; the functions of the
# second compile behind it.
awk '/^    #include <equimap.h>/ {on = 1} /^## Conventions/ {exit} on && (/^    / || /^$/) {sub(/^    /, ""); print}' \
    "$source_folder/../../docs/library.md" >"$work/page.c"
grep -q EqmSoupCreateFromRoot "$work/page.c"
# shellcheck disable=SC2086
mpicc -std=c11 -Wall -Werror -Wno-unused-function -o "$work/page" "$work/page.c" $flags
cd "$work"
"$installed/bin/equimap" generate hills -n 800 -o scan.ply >/dev/null
run ./page -monitor >monitored.txt
run ./page | tee page.txt
# Nothing is printed unasked; -monitor shows what the program shows.
[ "$(grep -c . page.txt)" -eq 1 ] && ! grep -q iteration page.txt && grep -q "^iteration " monitored.txt && grep -q "^converged: \|^not converged: " monitored.txt ||
  { echo "with -monitor:"; cat monitored.txt; exit 1; }
run "$installed/bin/equimap" disk scan.ply -o program.h5 -quiet >/dev/null || [ $? -eq 4 ]
python=/usr/bin/python3
[ -x "$python" ] || python=python3
"$python" - <<'EOF'
import h5py
with h5py.File("map.h5") as page, h5py.File("program.h5") as program:
    assert (page["map/coordinates"][:] == program["map/coordinates"][:]).all(), "another map than the program's"
EOF
