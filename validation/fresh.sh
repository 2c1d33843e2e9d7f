#!/usr/bin/env bash
# The two commands of the README in an empty Debian 12, with the tree as it is committed, and the time of each part. The root is
# build-fresh/root, made by debootstrap. Its mounts are in a namespace of their own, so that none outlives this program, however it ends.
set -euo pipefail
cd "$(dirname "$0")/.."
directory=$PWD/build-fresh
root=$directory/root
[[ $EUID -eq 0 ]] || { echo "./dev fresh needs root, to make a Debian 12 in build-fresh/root and to change into it: sudo ./dev fresh" >&2; exit 2; }
if [[ ${1:-} != --inside ]]; then
  unshare --mount --propagation private --pid --fork --kill-child validation/fresh.sh --inside &
  trap 'kill -KILL $! 2>/dev/null || true' EXIT  # with it ends whatever it has started
  trap 'exit 1' INT TERM
  wait $!
  exit
fi

# part NAME COMMAND…: runs it and notes its seconds.
declare -a parts=()
part() {
  local begin=$SECONDS
  "${@:2}"
  parts+=("$1: $((SECONDS - begin))")
}

. validation/empty_debian.sh

mount_system() {
  mount -t proc proc "$root/proc"
  mount --rbind /sys "$root/sys"
  mount --rbind /dev "$root/dev"
}

# in_root COMMAND: in the tree there, with nothing of this shell's environment but the way to the network.
in_root() {
  local variables
  mapfile -t variables < <(network_variables)
  env -i HOME=/root PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin LANG=C.UTF-8 TERM="${TERM:-dumb}" "${variables[@]}" \
    chroot "$root" /bin/bash -c "cd /root/gridlock && $1"
}

# try COMMAND: one of the two; its own lines say when each of its steps began.
try() {
  local name=${1#./dev } begin=$SECONDS status=0
  echo "fresh: $1"
  in_root "$1" 2>&1 | tee "$directory/$name.log" || status=$?
  mapfile -t -O "${#parts[@]}" parts < <(sed -nE "s/^$name \(([0-9]+):([0-9]+)\) (.*)/\1 \2 \3/p" "$directory/$name.log" |
    awk -v name="$name" -v end=$((SECONDS - begin)) '
      {
        now = $1 * 60 + $2
        if (NR > 1) print name ", " text ": " now - then
        then = now; $1 = $2 = ""; sub(/^ +/, ""); sub(/,.*|:.*/, ""); text = $0
      }
      END { print name ", " text ": " end - then; print name ", the whole: " end }')
  return $status
}

report() {
  echo "fresh: the time of each part, on $(nproc) cores, of commit $(git rev-parse --short HEAD)"
  printf '%s\n' "${parts[@]}" | awk '{ seconds = $NF; sub(/: [0-9]+$/, ""); printf "  %-60s %3d min %2d s\n", $0, seconds / 60, seconds % 60 }'
}

part "debootstrap" make_root
take_network
mount_system
mkdir "$root/root/gridlock"
git archive HEAD | tar -x -C "$root/root/gridlock"
trap report EXIT
try "./dev demo"
try "./dev test"
echo "fresh: both commands of the README work in an empty Debian 12"
