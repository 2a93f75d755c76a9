#!/usr/bin/env bash
# Measures the first scene in the laboratory, and puts plot and table into docs/accuracy.md:
# tools/accuracy.sh [PROGRAM]
set -euo pipefail
cd "$(dirname "$0")/.."
[ $# -gt 0 ] || cargo build --release --locked
program=${1:-target/release/marraztu}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$program" lab --quick --size 800x600 --out "$work" >"$work/said"
cp "$work/scatter.svg" docs/pictures/accuracy.svg
python3 - "$work/table.csv" <<'PYTHON'
import csv, pathlib, sys

rows = list(csv.DictReader(open(sys.argv[1])))
def front(row):
    if row["front"] != "true":
        return ""
    return "among samples" if row["against"] == "apart" else "yes"


lines = ["| choice | time | interquartile range | largest error | RMSE | differing bytes | pixels whose coverage differs | on the front |",
         "|---|--:|--:|--:|--:|--:|--:|---|"]
seen = set()
for row in rows:
    # The default stands once, at the head; combinations are in the plot.
    if row["group"] == "combinations" or (row["hash"], row["ratio"]) in seen:
        continue
    seen.add((row["hash"], row["ratio"]))
    axis = row["group"].split(", --")
    name = row["name"] if len(axis) == 1 else f"{axis[1]}: {row['name'].lower()}"
    time = f"{float(row['ratio']):.2f}" + ("" if row["verdict"] != "alike" or name == "Default" else " (alike)")
    lines.append(f"| {name} | {time} | {float(row['ratio_lower']):.2f} to {float(row['ratio_upper']):.2f} "
                 f"| {row['largest']} | {float(row['rmse']):.2g} | {100 * float(row['differing']):.2g}% "
                 f"| {row['coverage']} | {front(row)} |")
page = pathlib.Path("docs/accuracy.md")
text = page.read_text()
begin, end = "<!-- laboratory: made by tools/accuracy.sh -->\n", "<!-- laboratory: end -->"
before, rest = text.split(begin)
_, after = rest.split(end)
page.write_text(before + begin + "\n" + "\n".join(lines) + "\n\n" + end + after)
PYTHON
