#!/usr/bin/env bash
# The whole path in one command: a model dropped in a watched folder ends as a recorded print on a
# simulated Replicator. Everything it makes lies in build/demo.
#   ./demo.sh web   afterwards the daemon goes on, with its page for a browser, until Ctrl-C
set -euo pipefail
cd "$(dirname "$0")"
source src/install/install.sh

say() { printf '\n\033[1m%s\033[0m\n' "$*"; }

install_packages
install_npm_packages
say "Building (some minutes the first time)"
cmake --preset release >/dev/null
cmake --build build --target packmerger packmergerd packmerger-tetgen page | tail -n 1

export PATH=$PWD/build/bin:$PATH
demo=$PWD/build/demo
rm -rf "$demo"
mkdir -p "$demo/state" "$demo/drop"
node tests/fixtures/bunny_obj.js "$demo/bunny.obj"

cleanup() {
  local status=$? child
  for child in ${daemon:-} ${printer:-}; do kill "$child" 2>/dev/null || true; done
  wait
  [ "$status" -eq 0 ] || tail -n 20 "$demo"/*.log >&2
}
trap cleanup EXIT

say "Starting a simulated Replicator, at unlimited speed"
packmerger simulate replicator --speed inf --record "$demo/printed.txt" \
  > "$demo/address" 2> "$demo/simulator.log" &
printer=$!
until [ -s "$demo/address" ]; do kill -0 "$printer"; sleep 0.1; done
port=$(head -n 1 "$demo/address")
echo "It listens at $port and records what it executes in build/demo/printed.txt"

say "Starting the daemon with a watched folder"
cat > "$demo/packmergerd.toml" <<EOF
state = "state"

[web]
port = $([ "${1:-}" = web ] && echo 8310 || echo 0)
trust_local = false

[printer.replicator]
profile = "replicator"
port = "$port"
folder = "drop"
simulated = true
approve = "ask"
size_mm = 60
# a toy is not worth a dozen parts: each is to hold a tenth of it at least
set = ["min_volume_fraction=0.1"]
EOF
packmergerd --config "$demo/packmergerd.toml" 2> "$demo/daemon.log" &
daemon=$!
export PACKMERGER_SOCKET=$demo/state/packmergerd.sock
until packmerger printers list >/dev/null 2>&1; do kill -0 "$daemon"; sleep 0.1; done
packmerger printers list

# field NAME: one value of the job's JSON.
field() {
  packmerger jobs show 1 --json |
    node -e 'const job = JSON.parse(require("fs").readFileSync(0)); console.log(job[process.argv[1]] ?? "")' "$1"
}

# wait_for STATE...: shows the job's progress until it is in one of the states.
wait_for() {
  local state status shown=
  while true; do
    kill -0 "$daemon"
    state=$(field state 2>/dev/null || true)
    status=$(field status 2>/dev/null || true)
    [ "$status" = "$shown" ] || echo "  $status"
    shown=$status
    case " $* " in *" $state "*) return 0 ;; esac
    case $state in failed | cancelled) return 1 ;; esac
    sleep 0.5
  done
}

say "Dropping bunny.obj in build/demo/drop, to be made 60 mm long"
cp "$demo/bunny.obj" "$demo/drop/bunny.obj"
wait_for ready

say "What printing it takes, packed against unpacked"
packmerger jobs show 1

say "Approving the job and printing it"
packmerger jobs approve 1
wait_for done
# The record holds one action a line, in hex; 9a ends a build (docs/PROTOCOLS.md).
until grep -q '^9a' "$demo/printed.txt"; do kill -0 "$printer"; sleep 0.1; done
echo "The printer recorded the end of the build: $(wc -l < "$demo/printed.txt") commands."

say "Where everything lies"
folder=$(field folder)
cat <<EOF
  job folder    $folder
  picture       $folder/preview.png
  3D scenes     $folder/preview.glb, $folder/assembly.glb
  tray          $folder/tray.3mf
  program       $folder/program.x3g
  print record  $demo/printed.txt
  your model    $(field filed)
EOF
if [ "${1:-}" = web ]; then
  say "The page: $(packmerger keys link 2>/dev/null)"
  echo "  That link is good once, within 15 minutes, and lets a browser look."
  echo "  The key for whatever changes something: $(packmerger keys add demo 2>/dev/null)"
  echo "  Ctrl-C ends it."
  trap "exit 0" INT
  wait "$daemon"
fi
