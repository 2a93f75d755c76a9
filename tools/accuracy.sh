#!/usr/bin/env bash
# Measures the suite in the laboratory, counts its instructions by callgrind, and puts both into
# docs/accuracy.md, with the plots in docs/pictures/accuracy: tools/accuracy.sh [PROGRAM]
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
cargo test --locked --profile profiling --test proofs -- choices --figures "$work" >/dev/null
python3 - "$work" "$(date -u +%Y-%m-%d)" "$(git describe --always --dirty --exclude '*')" <<'PYTHON'
import pathlib, sys

work, page = pathlib.Path(sys.argv[1]), pathlib.Path("docs/accuracy.md")
text = page.read_text()
day, commit = sys.argv[2:]
for part, made in [
    ("laboratory", (work / "page.md").read_text().replace("](", "](pictures/accuracy/")),
    ("instructions", (work / "choices.md").read_text().strip() + "\n"),
]:
    begin, end = f"<!-- {part}: made by tools/accuracy.sh -->\n", f"<!-- {part}: end -->"
    before, rest = text.split(begin)
    _, after = rest.split(end)
    text = before + begin + f"\nMeasured on {day}, {commit}.\n\n" + made + "\n" + end + after
page.write_text(text)
PYTHON
