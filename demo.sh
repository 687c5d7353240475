#!/usr/bin/env bash
# What the program is for, in one command, through the daemon's watched folders: a bunny whose packing
# saves a PolyJet printer most of its time and support, put in the hand-over folder, and an arch too
# long for a Replicator, divided, packed and printed on a simulated one. All it makes lies in build/demo.
#   ./demo.sh web   afterwards the daemon goes on, with its page for a browser, until Ctrl-C
set -euo pipefail
cd "$(dirname "$0")"
source src/install/install.sh

case ${1:-} in
  "" | web) ;;
  *) echo "usage: ./demo.sh [web]" >&2; exit 2 ;;
esac

bold='' plain=''
[ -t 1 ] && bold=$'\033[1m' plain=$'\033[0m'
say() { printf '\n%s%s%s\n' "$bold" "$*" "$plain"; }

[ -x build/bin/packmerger ] || say "The first run installs packages (a few minutes) and builds everything (about twenty minutes on two cores, ten on four); the next take about a minute"
install_packages
install_npm_packages
say "Building"
cmake --preset release >/dev/null
build=(cmake --build build --target packmerger packmergerd packmerger-tetgen page)
# At a terminal one line counts the steps.
if [ -t 1 ]; then "${build[@]}"; else "${build[@]}" | tail -n 1; fi

export PATH=$PWD/build/bin:$PATH
demo=$PWD/build/demo
rm -rf "$demo"
mkdir -p "$demo/state" "$demo/objet30" "$demo/replicator" "$demo/objet-studio"
node tests/fixtures/bunny_obj.js "$demo/bunny.obj" standing
node tests/fixtures/arch_obj.js "$demo/arch.obj"

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

say "Starting the daemon with two printers, and a watched folder for each"
cat > "$demo/packmergerd.toml" <<EOF
state = "state"

[web]
port = $([ "${1:-}" = web ] && echo 8310 || echo 0)
trust_local = false

# takes no job by wire: finished trays are put where its own software looks for them
[printer.objet30]
profile = "objet30"
handoff_folder = "objet-studio"
folder = "objet30"
size_mm = 120
approve = "auto"

[printer.replicator]
profile = "replicator"
port = "$port"
folder = "replicator"
simulated = true
approve = "ask"
# so slim an arch is printed with the slicer's infill
hollow = false
EOF
packmergerd --config "$demo/packmergerd.toml" 2> "$demo/daemon.log" &
daemon=$!
export PACKMERGER_SOCKET=$demo/state/packmergerd.sock
until packmerger printers list >/dev/null 2>&1; do kill -0 "$daemon"; sleep 0.1; done
packmerger printers list

# fields JOB NAME...: values of the job's JSON, one a line.
fields() {
  packmerger jobs show "$1" --json | node -e 'const job = JSON.parse(require("fs").readFileSync(0));
    for (const name of process.argv.slice(1)) console.log(job[name] ?? "")' "${@:2}"
}

# wait_for JOB STATE...: shows the job's progress until it is in one of the states.
wait_for() {
  local job=$1 told state status shown=
  shift
  while true; do
    kill -0 "$daemon"
    mapfile -t told < <(fields "$job" state status 2>/dev/null)
    state=${told[0]:-} status=${told[1]:-}
    [ "$status" = "$shown" ] || echo "  $status"
    shown=$status
    case " $* " in *" $state "*) return 0 ;; esac
    case $state in failed | cancelled) return 1 ;; esac
    sleep 0.5
  done
}

say "1. A bunny for the Objet30: dropping bunny.obj in build/demo/objet30, to be made 120 mm long"
cp "$demo/bunny.obj" "$demo/objet30/bunny.obj"
wait_for 1 handed_over

say "What printing it takes, packed against in one piece"
packmerger jobs show 1
echo
echo "It was packed and pays, and approve = \"auto\": so it was put in the hand-over folder at once."

say "2. An arch of 300 mm, too long for the Replicator: dropping arch.obj in build/demo/replicator"
cp "$demo/arch.obj" "$demo/replicator/arch.obj"
wait_for 2 ready

say "What printing it takes: only in parts does it fit"
packmerger jobs show 2

say "Approving it and printing every tray on the simulated Replicator"
packmerger jobs approve 2
wait_for 2 done
# The record holds one action a line, in hex; 9a ends a build (docs/PROTOCOLS.md), one for each tray.
trays=$(fields 2 trays)
until [ "$(grep -c '^9a' "$demo/printed.txt")" -ge "$trays" ]; do kill -0 "$printer"; sleep 0.1; done
echo "Trays printed: $trays of $trays. The printer recorded $(wc -l < "$demo/printed.txt") commands."

say "Where everything lies"
handed=$(find "$demo/objet-studio" -mindepth 1 -maxdepth 1 -type d)
bunny=$(fields 1 folder)
arch=$(fields 2 folder)
cat <<EOF
  the bunny     picture       $bunny/preview.png
                3D scenes     $bunny/preview.glb, $bunny/assembly.glb
                handed over   $handed
                your model    $(fields 1 filed)
  the arch      picture       $arch/preview.png
                3D scenes     $arch/preview.glb, $arch/assembly.glb
                programs      $(printf '%s\n' "$arch"/program*.x3g | paste -sd ' ')
                print record  $demo/printed.txt
                your model    $(fields 2 filed)
EOF
if [ "${1:-}" = web ]; then
  trap "exit 0" INT
  say "The page: $(packmerger keys link 2>/dev/null)"
  echo "  That link is good once, within 15 minutes, and lets a browser look."
  echo "  The key for whatever changes something: $(packmerger keys add demo 2>/dev/null)"
  echo "  Ctrl-C ends it."
  wait "$daemon"
fi
