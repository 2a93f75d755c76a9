#!/usr/bin/env bash
# Makes docs/stability.md from what tests and proofs measure: tools/stability.sh [FOLDER]
#
# The proofs check the numbers of cases that the page promises, which takes some minutes. What FOLDER has
# from an earlier run is not measured again: `figures`, written by the hard cases with MARRAZTU_FIGURES and
# by the proofs with --figures, and `proofs`, the output of the proofs.
set -euo pipefail
cd "$(dirname "$0")/.."
page=docs/stability.md
if [ $# -gt 0 ]; then
  work=$1
else
  work=$(mktemp -d)
  trap 'rm -rf "$work"' EXIT
fi
if [ ! -d "$work/figures" ]; then
  mkdir -p "$work/figures"
  MARRAZTU_FIGURES="$work/figures" cargo test --locked --test hard_cases >"$work/tests" ||
    { cat "$work/tests" >&2; exit 1; }
fi
[ -f "$work/proofs" ] ||
  cargo test --release --locked --test proofs -- --whole --figures "$work/figures" >"$work/proofs"
cat "$work"/figures/[0-9]*.tsv >"$work/figures.tsv"

# Our figure of a case, by what is measured, with its unit.
ours() {
  awk -F'\t' -v number="$1" -v what="$2" '
    $1 == number && index($5, what) { print $8 " " $10; found = 1; exit }
    END { if (!found) { print "no figure of case " number ": " what > "/dev/stderr"; exit 1 } }
  ' "$work/figures.tsv"
}
# What a proof has counted.
counted() { awk -F'\t' '{ print $3 }' "$work/figures/proof-$1.tsv"; }
# The number of something that a proof has counted.
number() {
  counted "$1" | awk -v RS=', ' -v what="$2" 'index($0, what) == 1 { print $NF; exit }' | tr -d '\n'
}
# The number of mutations of rules that docs/breakages.md says were caught.
rules() {
  local all caught
  all=$(grep -c '^| plan |' docs/breakages.md) || true
  caught=$(grep -c '^| plan |.*| caught |' docs/breakages.md) || true
  [ "$all" -eq "$caught" ] || { echo "docs/breakages.md: $caught of $all rules caught" >&2; exit 1; }
  echo "$all"
}
# Cells of a table of Markdown.
group() {
  awk -F'\t' -v group="$1" '
    $2 == group {
      naive = $6 == "" ? "" : $6 ": **" $7 "**"
      again = $1 == last
      printf "| %s | %s | %s | %s | **%s** | %s | %s |\n", \
        again ? "" : $1 + 0, again ? "" : $4 " (" $3 ")", $5, naive, $8, $9, $10
      last = $1
    }
  ' "$work/figures.tsv"
}

{
cat <<TEXT
# Hard cases, in numbers

<!-- Made by tools/stability.sh: change that, or the tests, and run it again. -->

What a renderer promises is worth what it was measured by. This page lists the cases in which
programs of this kind go wrong, what a naive program does in each, what this one does, and the bound
that a test holds it to. Every number was measured by the run that made this page:

- $(date -u +%Y-%m-%d), $(git describe --always --dirty --exclude '*'), $(rustc --version | cut -d' ' -f1-2)
- $(awk -F': ' '/^model name/ { print $2; exit }' /proc/cpuinfo), $(nproc) threads

**What judges.** No case is judged by the code that it judges. Coverage is held against crossings of
rows, fractions of whole numbers of 128 bits (\`tests/proofs/claims/exact.rs\`), where the renderer has edge
functions; light and texture against rays and the equation written down once more
(\`tests/hard_cases/oracle.rs\`); placements against numbers of twice the digits of f64
(\`tests/proofs/claims/double_double.rs\`). Pictures are looked at from outside, byte by byte; where that is
too coarse, a picture is made a vernier: strips that begin a ten-thousandth of a pixel apart, rulers
whose texels are a last place wide, a series of pictures each 1/64 of a byte step brighter.

A letter after each case says what judges it: Z whole numbers or fractions; D twice the digits, or f64
along another way; I something that always holds; R two runs that have to agree.

**What is not claimed.** The oracles share with the program the scene (places of corners as f32) and
glam's vectors. If a way of drawing is not in the program (16 and 24 bits of depth, f32 coverage,
snapping to other grids, rsqrt, points every 0.1 unit), its column is **by number**: that arithmetic
alone was done in the test, not a picture drawn by it.

## What is promised, beside what others promise

| promise | measured here | others |
|---|---|---|
| coverage equals exact arithmetic | $(number samples samples) samples of triangles of every size, corners up to a million pixels off: **0 differ** | dEQP accepts edges 3 subpixels off |
| no crack, no double | $(number fans fans) closed fans, $(number fans samples) samples: **0 cracks, 0 doubles**, and the picture shows the right triangle at each | piglit draws 10 fans |
| depth within 2 last places of the largest corner, on any sliver | **$(ours 33 "depth on slivers")** | dEQP: a mantissa of 10 bits |
| attributes alike | **$(ours 33 "light in f32")**; with light in f64 **$(ours 33 "light in f64")** | the same |
| light in f64: at most 1 byte step, 0.05% of bytes | **$(ours 42 "largest difference of a byte in f64")**, **$(ours 42 "bytes in f64")** against the equation along rays | Mitsuba: 99.75% of pixels pass a Z-test |
| light of the editor within 0.25 byte step before rounding, Ns up to 128 | **$(ours 42 "before rounding, against a table")** | Vulkan's pow is unbounded in byte steps |
| a million key presses: 1e-9 radians | $(counted presses) | none states one |
| 100,000 commands undone and redone, bit for bit | $(counted undo): **0 bits differ**, in the files saved on the way neither | none states one |
| no panic, no NaN in hostile scenes | $(number scenes scenes) scenes, $(number scenes pictures) pictures, $(number scenes refusals) refusals: **0 panics, 0 pixels lost to a NaN** ($(number scenes "pixels on a border of light") stood on a border of light, and went dark in 64 bits too when lamps and objects moved by 2^-20; $(number scenes "scenes too bright") scenes with light beyond ten thousand times white were not judged) | D3D discards NaN only |
| what a plan leaves out changes no bit | $(number plan scenes) scenes drawn by a plan that leaves out nothing: **the same**; $(rules) rules made wrong: **all caught** ([mutation tests](breakages.md)) | none found |
| one picture on every processor | the list \`tests/pictures.sums\`, on every level of instructions of this processor, 1 to 16 threads: **the same** | FLIP's and egui's tests allow differences |

What stands in the way of more: hostile **files** are the business of \`fuzz/\`; one processor has seen
the list of pictures so far; tiles have one size, 64 x 64, so that other sizes cannot show.

To check any number of cases: \`cargo test --release --test proofs -- fans --count 1000000\`, or \`-- --list\` for
the names. A counterexample is named by its batch, and \`--from BATCH --count 1\` checks it again.

\`\`\`text
$(cat "$work/proofs")
\`\`\`

TEXT
for group in Geometry Clipping Coverage Depth Interpolation Light Colour Camera Undo "Files and scale" Shadows \
  Transparency Surfaces; do
  printf '## %s\n\n' "$group"
  printf '| case | what goes wrong | measured | elsewhere | ours | bound | unit |\n'
  printf '|--:|---|---|---|--:|--:|---|\n'
  group "$group"
  printf '\n'
done
} >"$work/page"
mv "$work/page" "$page"
