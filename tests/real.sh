#!/usr/bin/env bash
# Real input through the product's own commands: two raw scans of strangers, a person of ICT-FaceKit's model scanned
# again, two real marker takes; ends in review pages. Skips itself where the data is not there.
#
#   tests/real.sh [OUT]          OUT defaults to build/real
#   VULTUS_DATA=DIR              an unpacked copy of the data (see tests/run.sh)
#   VULTUS_REAL=quick            what tests/run.sh runs: fewer poses, one actor's take, few small frames
set -euo pipefail
top=$(cd "$(dirname "$0")/.." && pwd)
out=$(realpath -m "${1:-$top/build/real}")
bin=${VULTUS_BUILD:-$top/build/release}
vultus=$bin/apps/vultus
data=${VULTUS_DATA:-$top/build/data}
quick=${VULTUS_REAL:-full}

if [ ! -d "$data/ict-facekit" ]; then
  echo "real input: skipped (no ict-facekit under $data; set VULTUS_DATA to an unpacked copy of the data)"
  exit 77
fi

if [ "$quick" = quick ]; then
  region_counts="6"; takes="Jaw"; actors="demoface"; frames=2; size=96x96; spp=4
  ict_poses="neutral jawOpen mouthSmile_L"
else
  region_counts="1 6 12"; takes="Jaw Eyebrows"; actors="demoface james"; frames=24; size=512x512; spp=${SPP:-32}
  ict_poses=""
fi
mkdir -p "$out"

# The ICT topology as template and its expressions as databank, in millimetres.
"$vultus" rig databank "$data/ict-facekit" --out "$out/ict"

# 1. One raw neutral each.
capture() { mkdir -p "$out/captures/$1/scans"; cp "$2" "$out/captures/$1/scans/neutral.obj"; }
capture demoface "$data/meshmonk/DemoFace_10K.obj"
capture james "$data/menpo3d-james/james.obj"
cp "$data/menpo3d-james/james.jpg" "$data/menpo3d-james/james.obj.mtl" "$out/captures/james/scans/"
for actor in $actors; do
  "$vultus" onboard "$out/captures/$actor" --actor "$out/actors/$actor" --template "$out/ict/template.obj" \
    --databank "$out/ict" --json "$out/onboard_$actor.json"
done

# 2. Expression scans of one person whose vertices are known.
# shellcheck disable=SC2086  # a list of words
"$bin/tests/ict_person" scan "$data/ict-facekit" "$out/captures/ict_person" "$out/truth/ict_person" $ict_poses
"$vultus" onboard "$out/captures/ict_person" --actor "$out/actors/ict_person" --template "$out/ict/template.obj" \
  --json "$out/onboard_ict_person.json"
"$bin/tests/ict_person" compare "$out/truth/ict_person" "$out/actors/ict_person" "$out/ict_person_vertices.json"

# 3. Real takes on those actors.
for actor in $actors; do
  for regions in $region_counts; do
    session=$out/sessions/${actor}_${regions}
    paths=()
    for take in $takes; do paths+=("$data/animface-markers/$take.c3d"); done
    "$vultus" session "${paths[@]}" --actor "$out/actors/$actor" --session "$session" --regions "$regions" \
      --markers "$top/tests/real/animface_anchors.json" --json "$session.json"
    for take in $takes; do
      "$vultus" render "$session" --take "$take" --frames "300:$((300 + frames))" --size "$size" --spp "$spp"
    done
    "$vultus" review "$session"
  done
done
echo "review pages:"
find "$out/sessions" -path '*/review/index.html'
