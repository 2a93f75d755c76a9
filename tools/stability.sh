#!/usr/bin/env bash
# Makes docs/stability.md from the results of tests and proofs: tools/stability.sh [FOLDER]
#
# The proofs check as many cases as the page reports, which takes a few minutes. Results of an earlier run in
# FOLDER are reused: `figures`, written by the hard cases with MARRAZTU_FIGURES and by the proofs with
# --figures, and `proofs`, the output of the proofs.
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

# Our figure of a case, found by the measured quantity, with its unit.
ours() {
  awk -F'\t' -v number="$1" -v what="$2" '
    $1 == number && index($5, what) { print $8 " " $10; found = 1; exit }
    END { if (!found) { print "no figure of case " number ": " what > "/dev/stderr"; exit 1 } }
  ' "$work/figures.tsv"
}
# All counts of a proof.
counted() { awk -F'\t' '{ print $3 }' "$work/figures/proof-$1.tsv"; }
# One count of a proof.
number() {
  counted "$1" | awk -v RS=', ' -v what="$2" 'index($0, what) == 1 { print $NF; exit }' | tr -d '\n'
}
# The number of mutated rules that were caught, from docs/breakages.md.
rules() {
  local all caught
  all=$(grep -c '^| plan |' docs/breakages.md) || true
  caught=$(grep -c '^| plan |.*| caught |' docs/breakages.md) || true
  [ "$all" -eq "$caught" ] || { echo "docs/breakages.md: $caught of $all rules caught" >&2; exit 1; }
  echo "$all"
}
# The rows of a group's Markdown table.
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

A promise of accuracy is only as good as its measurement. This page lists inputs at which renderers and
editors commonly fail. Each row has the error of a naive implementation, our error, and the bound that a
test enforces. All numbers were measured by the run that made this page:

- $(date -u +%Y-%m-%d), $(git describe --always --dirty --exclude '*'), $(rustc --version | cut -d' ' -f1-2)
- $(awk -F': ' '/^model name/ { print $2; exit }' /proc/cpuinfo), $(nproc) threads

**Oracles.** No code is tested against itself. The renderer computes coverage with edge functions, and the
tests compare it with row crossings as exact 128-bit fractions (\`tests/proofs/claims/exact.rs\`). Light and
textures are compared with a ray tracer and a second implementation of the lighting equation
(\`tests/hard_cases/oracle.rs\`), placements with double-double arithmetic, at twice the digits of f64
(\`tests/proofs/claims/double_double.rs\`). Tests compare the bytes of finished pictures. To resolve less than a
pixel or a byte, they read the picture like a vernier: strips that begin a ten-thousandth of a pixel apart,
rulers with texels one last place wide, a series of pictures each 1/64 of a byte step brighter.

The letter after each case names its oracle: Z integers or fractions; D double-double arithmetic, or f64 by
another method; I an invariant; R two runs that must agree.

**Limits of the oracles.** They share the scene (corner positions as f32) and glam's vectors with the program.
Some alternatives are not in the program: depth in 16 and 24 bits, f32 coverage, snapping to other grids,
rsqrt, points every 0.1 unit. Their entries are marked **by number**: the test computed this arithmetic alone
and drew no picture with it.

## Guarantees, compared with other projects

| guarantee | measured here | other projects |
|---|---|---|
| coverage equals exact arithmetic | $(number samples samples) samples of triangles of all sizes, with corners up to a million pixels away: **0 differ** | dEQP accepts edges 3 subpixels off |
| no cracks, no pixel drawn twice | $(number fans fans) closed fans, $(number fans samples) samples: **0 cracks, 0 doubles**, and the picture shows the right triangle at each sample | piglit draws 10 fans |
| depth within 2 ulp of the largest corner, on any sliver | **$(ours 33 "depth on slivers")** | dEQP: a mantissa of 10 bits |
| the same for attributes | **$(ours 33 "light in f32")**; with light in f64 **$(ours 33 "light in f64")** | the same |
| light in f64: at most 1 byte step, 0.05% of bytes | **$(ours 42 "largest difference of a byte in f64")**, **$(ours 42 "bytes in f64")** against the equation along rays | Mitsuba: 99.75% of pixels pass a Z-test |
| light in the editor within 0.25 byte step before rounding, Ns up to 128 | **$(ours 42 "before rounding, against a table")** | Vulkan's pow has no bound in byte steps |
| a million key presses drift by at most 1e-9 radians | $(counted presses) | none stated |
| 100,000 commands are undone and redone bit for bit | $(counted undo): **0 bits differ**, in the scene and in the files saved on the way | none stated |
| hostile scenes cause no panic and no NaN | $(number scenes scenes) scenes, $(number scenes pictures) pictures, $(number scenes refusals) refusals: **0 panics, 0 pixels lost to a NaN** ($(number scenes "pixels on a border of light") lay on a border of light and also went dark in 64 bits when lamps and objects moved by 2^-20; $(number scenes "scenes too bright") scenes with light above ten thousand times white were not judged) | D3D only discards NaN |
| omissions of the plan change no bit | $(number plan scenes) scenes match a plan that omits nothing: **the same**; $(rules) broken rules: **all caught** ([mutation tests](breakages.md)) | none found |
| identical pictures on all processors | the list \`tests/pictures.sums\`, with every instruction set of this processor, 1 to 16 threads: **the same** | FLIP's and egui's tests allow differences |

Not covered: hostile **files**, which \`fuzz/\` tests; processors other than the one that drew the list of
pictures; and tile sizes other than 64 x 64, the only one in the program.

To check any number of cases, run \`cargo test --release --test proofs -- fans --count 1000000\`; \`-- --list\`
prints the names. A counterexample is identified by its batch: \`--from BATCH --count 1\` checks it again.

\`\`\`text
$(cat "$work/proofs")
\`\`\`

TEXT
for group in Geometry Clipping Coverage Depth Interpolation Light Colour Camera Undo "Files and scale" Shadows \
  Transparency Surfaces; do
  printf '## %s\n\n' "$group"
  printf '| case | failure | measured | naive | ours | bound | unit |\n'
  printf '|--:|---|---|---|--:|--:|---|\n'
  group "$group"
  printf '\n'
done
} >"$work/page"
mv "$work/page" "$page"
