#!/usr/bin/env bash
# Installs what is missing, builds with tests, and runs every test.
#   ./test.sh               release build in build/, everything
#   ./test.sh debug|thread  the clang builds with sanitizers, the tests that are meant for them
set -euo pipefail
cd "$(dirname "$0")"
source src/install/install.sh

preset=${1:-release}
install_packages
install_npm_packages
export PACKMERGER_MODELS=${PACKMERGER_MODELS:-$(pwd)/../shared/models}

case $preset in
  # One test more than there are cores: many wait for a printer, a clock or a browser.
  release) folder=build; targets=(all); selection=(-j "$(($(nproc) + 1))") ;;
  # Links and daemon have the fuzzers here, and their own tests under the thread sanitizer.
  debug) folder=build-debug; targets=(unit_tests fuzz_tests packmerger-tetgen); selection=(-j "$(nproc)" -L '^unit$|fuzz') ;;
  thread) folder=build-thread; targets=(unit-threads_tests); selection=(-j "$(nproc)" -L unit-threads) ;;
  *) echo "usage: ./test.sh [release|debug|thread]" >&2; exit 2 ;;
esac
# Sanitizers make code five to ten times slower; the generated models cover the same code as the real ones.
[ "$preset" = release ] || export PACKMERGER_MODELS=/nonexistent RC_PARAMS="max_success=20" PACKMERGER_HEAPS=10
cmake --preset "$preset" -DPACKMERGER_TESTS=ON >/dev/null
cmake --build "$folder" --target "${targets[@]}"
report=$folder/ctest.txt
status=0
ctest --test-dir "$folder" --output-on-failure "${selection[@]}" | tee "$report" || status=$?
echo "Skipped tests: $(grep -c "\*\*\*Skipped" "$report" || true)"
grep -E 'tests passed|tests failed|Total Test time' "$report" || true
exit "$status"
