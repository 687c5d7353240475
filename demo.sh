#!/usr/bin/env bash
# The whole path in one command: a model dropped in a watched folder ends as a recorded print on a
# simulated Replicator. Leaves its pictures and files in build/demo/.
set -euo pipefail
cd "$(dirname "$0")"
source src/install/install.sh

install_packages
install_npm_packages
echo "Building (the first time takes some minutes) ..."
cmake --preset release -DPACKMERGER_TESTS=OFF >/dev/null
cmake --build build --target packmerger packmergerd packmerger-tetgen | tail -n 1

export PATH=$PWD/build/bin:$PATH
demo=$PWD/build/demo
rm -rf "$demo"
mkdir -p "$demo/state"
node tests/fixtures/bunny_obj.js > "$demo/bunny.obj"

cleanup() {
  local job
  for job in ${daemon:-} ${printer:-}; do kill "$job" 2>/dev/null || true; done
  wait 2>/dev/null || true
}
trap cleanup EXIT

# A Replicator that does not exist, at unlimited speed; it records every command it executes.
packmerger simulate replicator --speed inf --record "$demo/printed.txt" > "$demo/pty" 2> "$demo/simulator.log" &
printer=$!
until [ -s "$demo/pty" ]; do sleep 0.1; kill -0 $printer; done
port=$(head -n 1 "$demo/pty")
echo "A simulated Replicator listens at $port"

cat > "$demo/packmergerd.toml" <<EOF
state = "$demo/state"

[printer.replicator]
profile = "replicator"
port = "$port"
simulated = true
approve = "ask"
folder = "$demo/drop"
size_mm = 60
EOF
packmergerd --config "$demo/packmergerd.toml" 2> "$demo/daemon.log" &
daemon=$!
export PACKMERGER_SOCKET=$demo/state/packmergerd.sock
until packmerger printers list >/dev/null 2>&1; do sleep 0.1; kill -0 $daemon; done

echo "Dropping bunny.obj, to be 60 mm long, in the watched folder $demo/drop"
cp "$demo/bunny.obj" "$demo/drop/bunny.obj"
