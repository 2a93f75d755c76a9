#!/usr/bin/env bash
# Makes the pictures of the README again: tools/pictures.sh [PROGRAM]
#
# The three examples are drawn without a window; the window is shown on a virtual display.
set -euo pipefail
cd "$(dirname "$0")/.."
DEBIAN_FRONTEND=noninteractive .ci/install xvfb xdotool imagemagick pngquant libgl1-mesa-dri
program=${1:-target/release/marraztu}
[ $# -gt 0 ] || cargo build --release --locked
pictures=docs/pictures
mkdir -p $pictures
for example in still-life chess harbour; do
  "$program" render --quiet assets/examples/$example.marraztu --size 640x400 --out $pictures/$example.png
done

work=$(mktemp -d)
export LIBGL_ALWAYS_SOFTWARE=1 XDG_CONFIG_HOME="$work/config" XDG_DATA_HOME="$work/data"
export XDG_STATE_HOME="$work/state" XDG_CACHE_HOME="$work/cache"
unset WAYLAND_DISPLAY WAYLAND_SOCKET
editor= xvfb=
trap 'kill $editor $xvfb 2>/dev/null || true; wait 2>/dev/null || true; rm -rf "$work"' EXIT
mkfifo "$work/number"
Xvfb -displayfd 3 -screen 0 1280x800x24 -noreset 3>"$work/number" >"$work/xvfb" 2>&1 &
xvfb=$!
read -r -t 60 number <"$work/number" || { cat "$work/xvfb" >&2; exit 1; }
export DISPLAY=":$number"

# The number of pixels that differ between the last two shots; large numbers are written as 1.2e+06.
moving() {
  { compare -metric AE "$work/last.png" "$work/now.png" null: 2>&1 || true; } | awk '{ printf "%d\n", $1 }'
}

# A picture of the window with these files, once it shows something and has stood still.
window() {
  # The last change is that of the dial, which needs some seconds.
  local name=$1 quiet=0 end=$((SECONDS + 90))
  shift
  "$program" "$@" 2>"$work/editor" &
  editor=$!
  xdotool mousemove 1150 740
  import -window root "$work/now.png"
  while [ $quiet -lt 12 ]; do
    [ $SECONDS -lt $end ] || { echo "tools/pictures.sh: no still picture of $name" >&2; exit 1; }
    kill -0 $editor || { cat "$work/editor" >&2; exit 1; }
    mv "$work/now.png" "$work/last.png"
    sleep 0.5
    import -window root "$work/now.png"
    quiet=$((quiet + 1))
    [ "$(moving)" -eq 0 ] && [ "$(identify -format %k "$work/now.png")" -gt 200 ] || quiet=0
  done
  kill $editor
  wait $editor 2>/dev/null || true
  editor=
  cp "$work/now.png" "$pictures/$name.png"
}
window editor assets/examples/harbour.marraztu

# All colours are kept if the file is small enough, else a palette.
for picture in $pictures/*.png; do
  convert "$picture" -strip -define png:compression-level=9 -define png:exclude-chunk=all "$work/small.png"
  [ "$(stat -c %s "$work/small.png")" -lt 250000 ] ||
    pngquant --force --speed 1 --output "$work/small.png" 256 "$picture"
  [ "$(stat -c %s "$work/small.png")" -lt 400000 ] || { echo "$picture is too large" >&2; exit 1; }
  mv "$work/small.png" "$picture"
done
