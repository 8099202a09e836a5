#!/usr/bin/env bash
# Do what jobs/apptainer.def says, without Apptainer: its sections %setup, %post and %test, in a Debian 12 of its own that
# debootstrap makes. As root, with a network and some 3 GB in the folder; half an hour at most.
#   tests/container.sh [FOLDER]     FOLDER is made anew, and removed at the end; default: a temporary one
# Exit code 77: there is no root or no debootstrap here.
set -euo pipefail
cd "$(dirname "$0")/.."
definition=$PWD/jobs/apptainer.def
if [ "$(id -u)" -ne 0 ] || ! command -v debootstrap >/dev/null; then
  echo "container: left out, it takes root and debootstrap"
  exit 77
fi
folder=${1:-$(mktemp -d /var/tmp/equimap-container-XXXXXX)}
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)

unmount() {
  umount "$folder/root/dev/shm" "$folder/root/dev" "$folder/root/proc" 2>/dev/null || true
}
trap 'unmount; rm -rf --one-file-system "$folder"' EXIT

# The lines of a section, up to the next one.
section() {
  awk -v name="%$1" '/^%/ { inside = ($1 == name); next } inside' "$definition"
}
# In the container, as Apptainer does it: a shell that ends at the first command that fails.
inside() {
  { echo "set -e"; section "$1"; } >"$folder/root/section.sh"
  env -i PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 DEBIAN_FRONTEND=noninteractive \
    ${http_proxy:+http_proxy="$http_proxy"} ${https_proxy:+https_proxy="$https_proxy"} APPTAINER_LABELS=/labels \
    chroot "$folder/root" /bin/sh /section.sh
}

mirror=$(awk '$1 == "deb" && $2 ~ /^http/ { print $2; exit }' /etc/apt/sources.list 2>/dev/null || true)
[ -n "$mirror" ] || mirror=$(awk '$1 == "URIs:" { print $2; exit }' /etc/apt/sources.list.d/*.sources 2>/dev/null || true)
[ -n "$mirror" ] || { echo "container: this system names no Debian mirror; not run"; exit 77; }
echo "container: Debian 12 from $mirror"
debootstrap --variant=minbase bookworm "$folder/root" "$mirror" >"$folder/debootstrap.log" 2>&1 ||
  { tail -n 20 "$folder/debootstrap.log"; exit 1; }
mount --bind /dev "$folder/root/dev"
mount -t tmpfs tmpfs "$folder/root/dev/shm"
mount -t proc proc "$folder/root/proc"
# Apt's own settings (proxies, mirrors) are those of this machine.
cp /etc/resolv.conf "$folder/root/etc/" 2>/dev/null || true
find /etc/apt/apt.conf.d -name '*proxy*' -exec cp {} "$folder/root/etc/apt/apt.conf.d/" \;

commit=$(git rev-parse --short HEAD)
for name in setup post test; do
  echo "container: %$name"
  if [ "$name" = setup ]; then
    APPTAINER_ROOTFS=$folder/root bash -ec "$(section setup)"
  else
    inside "$name" >"$folder/$name.log" 2>&1 || { tail -n 40 "$folder/$name.log"; exit 1; }
  fi
done
grep -qx "org.opencontainers.image.revision $commit" "$folder/root/labels" || { echo "container: the commit is not in the labels"; exit 1; }
[ ! -e "$folder/root/src" ] || { echo "container: the sources were left behind"; exit 1; }
echo "container: built, tested, commit $commit, $(wc -l <"$folder/root/usr/local/share/equimap/packages.txt") packages, $(du -sxh "$folder/root" | cut -f1)"
