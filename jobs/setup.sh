#!/usr/bin/env bash
# Install the Debian 12 packages that equimap needs and that are missing; nothing is done, and no network asked for, when
# all are there. As root, or with sudo.
#   jobs/setup.sh            to build, run and draw
#   jobs/setup.sh --tests    and what the tests use beside that
#   jobs/setup.sh --list     only say what is missing
set -euo pipefail

packages=(gcc libc6-dev make cmake pkg-config python3 python3-numpy python3-h5py
          libopenmpi-dev openmpi-bin libpetsc-real-dev libmumps-dev libmetis-dev libsuitesparse-dev libhdf5-openmpi-dev
          libslepc-real-dev libopenblas0-serial libxml2-dev libcjson-dev zlib1g-dev libcairo2-dev fonts-dejavu-core)
list_only=no
for argument in "$@"; do
  case $argument in
    --tests) packages+=(git doxygen groff-base valgrind slurm-wlm munge jube environment-modules python3-matplotlib python3-meshio
                       clang-14 libclang-rt-14-dev libomp-14-dev) ;;
    --list) list_only=yes ;;
    *) echo "usage: jobs/setup.sh [--tests] [--list]" >&2; exit 2 ;;
  esac
done

if ! command -v dpkg-query >/dev/null; then
  echo "setup: not a Debian system; see spack/ for another way to get what equimap stands on" >&2
  exit 0
fi

# The pkg-config command comes from either of two packages.
is_installed() {
  [ "$1" = pkg-config ] && command -v pkg-config >/dev/null && return 0
  [ "$(dpkg-query -W -f '${db:Status-Status}' "$1" 2>/dev/null || true)" = installed ]
}
missing=()
for package in "${packages[@]}"; do
  is_installed "$package" || missing+=("$package")
done
if [ $list_only = yes ]; then
  [ ${#missing[@]} -eq 0 ] || printf '%s\n' "${missing[@]}"
  exit 0
fi
[ ${#missing[@]} -eq 0 ] && exit 0

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  if ! command -v sudo >/dev/null; then
    echo "setup: these packages are missing, and installing them takes root: ${missing[*]}" >&2
    exit 1
  fi
  as_root=(sudo)
fi
echo "setup: installing ${missing[*]}"
log=$(mktemp)
trap 'rm -f "$log"' EXIT
export DEBIAN_FRONTEND=noninteractive
if ! { "${as_root[@]}" apt-get update && "${as_root[@]}" apt-get install -y --no-install-recommends "${missing[@]}"; } >"$log" 2>&1; then
  tail -n 20 "$log" >&2
  echo "setup: apt-get failed" >&2
  exit 1
fi
