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

# The mirror that this machine takes its packages from, where it is a Debian 12 too.
mirror() { apt-get indextargets --format '$(CODENAME) $(REPO_URI)' 'Created-By: Packages' 2>/dev/null | sed -n 's/^bookworm //p' | head -n 1; }

make_root() {
  rm -rf --one-file-system "$directory"
  mkdir -p "$directory"
  debootstrap --variant=minbase bookworm "$root" $(mirror) >"$directory/debootstrap.log" 2>&1 ||
    { tail -n 20 "$directory/debootstrap.log" >&2; return 1; }
}

# take PATH…: files of this machine at the same place in the root, links as what they lead to.
take() {
  for path in "$@"; do
    [[ -e $path ]] || continue
    mkdir -p "$root$(dirname "$path")"
    cp -rL "$path" "$root$(dirname "$path")" 2>/dev/null || true  # links that lead nowhere are of no use there either
  done
}

# Variables about proxies, certificates and indices, as this machine has them.
network_variables() {
  env | grep -iE '^([a-z]*_proxy|pip_[a-z_]*|npm_config_[a-z_]*|[a-z0-9_]*(_ca_|_certs?|cainfo|_bundle)[a-z0-9_]*)=' || true
}

# How this machine reaches the network: mirrors, proxies, certificates and indices, nothing else of it.
take_network() {
  if [[ -n $(mirror) ]]; then
    rm -f "$root/etc/apt/sources.list"
    take /etc/apt/sources.list /etc/apt/sources.list.d /etc/apt/keyrings /etc/apt/trusted.gpg.d /usr/share/keyrings
  fi
  apt-config dump | grep -E '^Acquire::[^ ]+ ".+";' | grep -vE '^Acquire::(IndexTargets|Changelogs|CompressionTypes)' \
    >"$root/etc/apt/apt.conf.d/90fresh" || true
  take /etc/resolv.conf /etc/hosts /etc/ssl/certs/ca-certificates.crt /etc/pip.conf /etc/npmrc "$HOME/.npmrc" "$HOME/.config/pip"
  # The package ca-certificates writes its bundle anew, of its own and of what lies here.
  mkdir -p "$root/usr/local/share/ca-certificates"
  cp /etc/ssl/certs/ca-certificates.crt "$root/usr/local/share/ca-certificates/machine.crt" 2>/dev/null || true
  network_variables | while IFS='=' read -r _ value; do
    [[ $value != /* || -e $root$value ]] || take "$value"
  done
}

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
