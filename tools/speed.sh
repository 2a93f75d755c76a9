#!/usr/bin/env bash
# Makes docs/speed.md and its plots again: tools/speed.sh [PEERS.csv]
#
# The benchmarks take some minutes. PEERS.csv is the table that a run of the comparison with other
# renderers has left, with ours labelled marraztu and, with --instructions avx2, marraztu-avx2; without
# it the last one stays.
set -euo pipefail
cd "$(dirname "$0")/.."
[ $# -eq 0 ] || grep -E '^round|,(llvmpipe-host|marraztu|marraztu-avx2),' "$1" >docs/speed/peers.csv
cargo bench --locked --bench drawing
cargo bench --locked --bench page
