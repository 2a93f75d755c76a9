#!/usr/bin/env bash
# Makes docs/keys.md and the tables of axes and scenes in docs/accuracy.md again, from the program's tables.
set -euo pipefail
cd "$(dirname "$0")/.."
MARRAZTU_WRITE_PAGES=1 cargo test --locked --test pages
