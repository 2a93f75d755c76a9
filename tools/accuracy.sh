#!/usr/bin/env bash
# Measures the suite in the laboratory, and puts its page into docs/accuracy.md, with its plots in
# docs/pictures/accuracy: tools/accuracy.sh [PROGRAM]
set -euo pipefail
cd "$(dirname "$0")/.."
[ $# -gt 0 ] || cargo build --release --locked
program=${1:-target/release/marraztu}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$program" lab --suite --out "$work" >"$work/said"
rm -rf docs/pictures/accuracy docs/pictures/accuracy.svg
mkdir docs/pictures/accuracy
cp "$work"/*-light.svg docs/pictures/accuracy/
python3 - "$work/page.md" <<'PYTHON'
import pathlib, sys

made = pathlib.Path(sys.argv[1]).read_text().replace("](", "](pictures/accuracy/")
page = pathlib.Path("docs/accuracy.md")
begin, end = "<!-- laboratory: made by tools/accuracy.sh -->\n", "<!-- laboratory: end -->"
before, rest = page.read_text().split(begin)
_, after = rest.split(end)
page.write_text(before + begin + "\n" + made + "\n" + end + after)
PYTHON
