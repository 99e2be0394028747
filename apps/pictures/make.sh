#!/usr/bin/env bash
# README's pictures of the demo, but for real.jpg (tests/real.sh): apps/pictures/make.sh DEMO
# DEMO is what apps/demo.sh wrote. Needs oiiotool and chromium.
set -euo pipefail
top=$(cd "$(dirname "$0")/../.." && pwd)
demo=$(realpath "$1")
vultus=${VULTUS_BUILD:-$top/build/release}/apps/vultus
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

# page HTML#LINK WxH PICTURE
page() {
  chromium --headless --no-sandbox --hide-scrollbars --use-gl=angle --use-angle=swiftshader --user-data-dir="$work/browser" \
    --virtual-time-budget=6000 --window-size="$2" --screenshot="$work/$3" "file://$1" 2>/dev/null
}
jpeg() { oiiotool "$@" --ch R,G,B --compression jpeg:85 -o "$top/apps/pictures/$picture.jpg"; }

picture=performance
render=$demo/session/render
jpeg "$render"/emotions/reference/000080.png "$render"/asymmetry/reference/000320.png \
  "$render"/emotions/reference/000{400,480,640}.png "$render"/asymmetry/reference/000880.png --mosaic 6x1 --resize 1584x264

picture=poses
for pose in "$demo"/actor/report/*.png; do oiiotool "$pose" --cut 202x288+619+0 --resize 142x202 -o "$(basename "$pose")"; done
jpeg ./*.png --mosaic 11x2

picture=review
page "$demo/session/review/index.html#take=emotions&frame=400" 1500,5000 page.png
jpeg page.png --resize 700x2333

picture=mocap
"$vultus" simulate studio --triangles 1000 --no-clutter --performances speech --marker-missing 0.05 --faults 3 --quiet
"$vultus" session studio/capture/mocap/speech.c3d --training studio/capture/mocap/training.c3d --actor "$demo/actor" \
  --session session --quiet >/dev/null
"$vultus" review session --quiet
page "$work/session/review/index.html#take=speech&marker=LNLF3&frame=150" 1500,5000 page.png
jpeg page.png --cut 1460x1528+20+1776 --resize 1000x1047
