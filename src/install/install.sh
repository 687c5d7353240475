# Read by demo.sh and test.sh: installs what is missing. Changes nothing where all is there.
# shellcheck shell=bash

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)

missing_packages() {
  sed 's/#.*//' "$root/src/install/packages.txt" | awk 'NF {print $1}' | while read -r package; do
    dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || echo "$package"
  done
  # An npm that is there is used as it is: Debian's cannot be installed beside a newer node.
  command -v npm >/dev/null || echo npm
  command -v node >/dev/null || echo nodejs
}

install_packages() {
  local missing
  missing=$(missing_packages | tr '\n' ' ')
  [ -z "${missing// /}" ] && return 0
  if [ "$(id -u)" -ne 0 ]; then
    echo "Some packages are missing and only root can install them; run: sudo apt-get install -y --no-install-recommends $missing" >&2
    return 1  # whoever sourced this in a shell of his own keeps it
  fi
  echo "Installing: $missing"
  export DEBIAN_FRONTEND=noninteractive
  apt-get update -qq
  # shellcheck disable=SC2086
  apt-get install -y -qq --no-install-recommends $missing >/dev/null
}

install_npm_packages() {
  if ! cmp -s "$root/package-lock.json" "$root/node_modules/.installed-lock"; then
    (cd "$root" && npm ci --no-audit --no-fund --loglevel=error)
    cp "$root/package-lock.json" "$root/node_modules/.installed-lock"
  fi
}
