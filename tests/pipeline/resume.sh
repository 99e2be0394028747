#!/usr/bin/env bash
# The whole pipeline on a small synthetic capture: work is done once, continues after a kill, repairs what is damaged,
# and does not depend on the number of threads.
. "$(dirname "$0")/checks.bash"

# Waits until a file is there (60 s at most), then interrupts the process and waits for its end.
interrupt_once() {
  local process=$1 file=$2 tries=0
  until [ -e "$file" ] || [ $tries -ge 1200 ]; do sleep 0.05; tries=$((tries + 1)); done
  kill -"${3:-INT}" "$process" 2>/dev/null
  wait "$process" 2>/dev/null
  status=$?
}
number() { sed -n "s/^  *\"$2\": \([0-9]*\),*$/\1/p" "$1" | head -n 1; }

small=(--poses jaw_open smile_closed --triangles 30000 --performances asymmetry --seconds 1 --landmarks)
mkdir one two
run "$vultus" simulate one --threads 1 "${small[@]}" --quiet
[ "$status" = 0 ] && ok "simulate" || { fail "simulate: $err"; exit 1; }
"$vultus" simulate two --threads 2 "${small[@]}" --quiet >/dev/null 2>&1
same "simulate does not depend on threads" one two
rm -rf two/capture && cp -r one/capture two/capture
expect "simulate again does nothing" 0 "nothing has changed" "$vultus" simulate one "${small[@]}"
[ -z "$(find . -name '*.partial*')" ] && ok "no temporary files" || fail "temporary files: $(find . -name '*.partial*')"

# onboard: interrupted, continued, against one that ran through
onboard=("$vultus" onboard capture --actor actor --regions 3 --quiet)
(cd one && exec "${onboard[@]}" --threads 1 >/dev/null 2>&1) &
interrupt_once $! one/actor/poses/neutral.ply
[ "$status" = 130 ] && ok "an interrupted onboarding says so" || fail "an interrupted onboarding: status $status"
(cd one && "${onboard[@]}" --threads 1 --json ../continued.json >/dev/null 2>"$work/.err")
onboarded=$?
(cd two && "${onboard[@]}" --threads 2 --json ../through.json >/dev/null 2>&1)
case $onboarded in 0 | 5) ok "onboard continues" ;; *) fail "onboard continues: $onboarded $(cat "$work/.err")" ;; esac
[ "$(number continued.json reused)" -ge 1 ] && ok "finished poses are kept" || fail "finished poses are kept"
same "an actor continued with one thread equals one made at once with two" one/actor two/actor
(cd one && "${onboard[@]}" --json ../again.json >/dev/null 2>&1)
[ "$(number again.json registered)" = 0 ] && ok "onboard again registers nothing" || fail "onboard again registers nothing"

# damage
expect "a sound actor" 0 "" "$vultus" inspect one/actor
printf x >>one/actor/poses/jaw_open.ply
expect "a damaged pose is named" 2 "poses/jaw_open.ply" "$vultus" inspect one/actor
expect "a damaged actor is refused" 2 "poses/jaw_open.ply" \
  "$vultus" session one/capture/mocap/asymmetry.c3d --actor one/actor --session one/refused
(cd one && "${onboard[@]}" --json ../repaired.json >/dev/null 2>&1)
[ "$(number repaired.json registered)" = 1 ] && ok "only the damaged pose is redone" || fail "only the damaged pose is redone"
same "the repaired actor" one/actor two/actor
sed -i 's/"jaw_open"/"jaw_opem"/' one/actor/actor.json
expect "a manifest edited by hand is named" 2 "actor.json" "$vultus" inspect one/actor
(cd one && "${onboard[@]}" --force >/dev/null 2>&1)
same "--force makes all of it again" one/actor two/actor
head -c 5000 two/capture/scans/jaw_open.ply >broken.ply
cp -r two/capture broken && mv broken.ply broken/scans/jaw_open.ply
expect "a truncated scan is named, the others come through" 2 "jaw_open.ply" "$vultus" onboard broken --actor broken_actor
[ -e broken_actor/poses/smile_closed.ply ] && [ ! -e broken_actor/poses/jaw_open.ply ] && ok "poses beside a broken scan" ||
  fail "poses beside a broken scan: $(ls broken_actor/poses)"

# session
session=("$vultus" session capture/mocap/asymmetry.c3d --training capture/mocap/training.c3d --actor "$work/two/actor" --session session)
(cd one && exec "${session[@]}" --threads 1 >/dev/null 2>&1) &
interrupt_once $! one/session/takes/training/clean.c3d
(cd one && "${session[@]}" --threads 1 >"$work/continued.csv" 2>"$work/.err") && ok "session continues" || fail "session: $(cat "$work/.err")"
(cd two && "${session[@]}" --threads 2 >"$work/through.csv" 2>/dev/null)
same "a session continued with one thread equals one made at once with two" one/session two/session
same "and so do the tables" continued.csv through.csv
(cd one && "${session[@]}" --json ../session_again.json >/dev/null 2>&1)
[ "$(number session_again.json reused)" = 1 ] && ok "session again solves nothing" || fail "session again solves nothing"
printf x >>one/session/takes/asymmetry/weights.npy
expect "damaged weights are refused" 2 "weights.npy" "$vultus" render one/session --take asymmetry
(cd one && "${session[@]}" >/dev/null 2>&1)
same "damaged weights are made again" one/session two/session
expect "unknown take" 1 'did you mean "asymmetry"' "$vultus" render one/session --take asymetry
expect "frames beyond the take" 1 "0 to 119" "$vultus" render one/session --take asymmetry --frames 100:999

# render
render=("$vultus" render session --take asymmetry --frames 0:4 --size 64x64 --spp 32 --quiet)
(cd one && exec "${render[@]}" --threads 1 >/dev/null 2>&1) &
interrupt_once $! one/session/render/asymmetry/reference/000000.json KILL
(cd one && "${render[@]}" --threads 1 --json ../rendered.json >/dev/null 2>&1)
(cd two && "${render[@]}" --threads 2 >/dev/null 2>&1)
[ "$(number rendered.json rendered)" -lt 4 ] && ok "a killed rendering continues" || fail "a killed rendering continues: $(number rendered.json rendered)"
find one/session two/session -name '.*partial*' -delete # what a kill -9 leaves; never taken for a frame
same "frames do not depend on threads or kills" one/session/render two/session/render

# review
expect "review" 0 "" "$vultus" review one/session
grep -q '</html>' one/session/review/index.html && ok "the page is whole" || fail "the page is whole"
exit $bad
