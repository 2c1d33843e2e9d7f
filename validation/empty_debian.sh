# An empty Debian 12 in $root, within the folder $directory, and the way to the network as this machine has it; and packages that are for another
# machine or another Debian. dev, validation/fresh.sh and the scripts of packaging/ read this file.

# The mirror that this machine takes its packages from, where it is a Debian 12 too.
mirror() {
  apt-get indextargets --format '$(CODENAME) $(REPO_URI)' 'Created-By: Packages' 2>/dev/null |
    sed -n '/^bookworm /{s///p;q}' || true
}

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

# list_packages FOLDER ARCHITECTURE RELEASE [deb-src]: a list of packages, in FOLDER, that this machine's own apt-get knows nothing of: those of a
# Debian, from where this machine gets its own if it is one. $apt_options are those of apt-get for it.
list_packages() {
  local from kind
  mkdir -p "$1"/{lists/partial,archives/partial}
  : >"$1/status"
  from=$(mirror)
  for kind in deb "${@:4}"; do
    echo "$kind [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] ${from:-http://deb.debian.org/debian} $3 main"
  done >"$1/sources.list"
  apt_options=(-qq -o Dir::Etc::sourcelist="$1/sources.list" -o Dir::Etc::sourceparts=- -o Dir::State="$1" -o Dir::State::status="$1/status"
    -o Dir::Cache="$1" -o APT::Architecture="$2" -o APT::Architectures="$2" -o APT::Sandbox::User=)
  apt-get "${apt_options[@]}" update
}

# unpack_packages FOLDER ROOT PACKAGE…: packages of that list and what they depend on, unpacked in ROOT; nothing of them is installed.
unpack_packages() {
  local package
  mkdir -p "$2"
  apt-get "${apt_options[@]}" install --yes --no-install-recommends --download-only "${@:3}" >/dev/null
  for package in "$1"/archives/*.deb; do dpkg -x "$package" "$2"; done
}
