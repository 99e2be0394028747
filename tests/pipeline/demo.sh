#!/usr/bin/env bash
# The whole demo, as apps/demo.sh runs it, against the truth of its synthetic actors.
. "$(dirname "$0")/checks.bash"

begin=$SECONDS
run "$vultus" demo demo --json demo.json
case $status in 0 | 5) ok "the demo ends" ;; *) fail "the demo ends: status $status: $(tail -n 3 <<<"$err")"; exit 1 ;; esac
echo "   $((SECONDS - begin)) s"
page=demo/session/review/index.html
[ -s "$page" ] && ! grep -qE '(src|href)="https?:' "$page" && ok "a page without outside links" || fail "a page without outside links"
"${VULTUS_BUILD:-$top/build/release}/tests/demo_truth" demo
sum=$(sha256sum "$page")
run "$vultus" demo demo
[ "$(sha256sum "$page")" = "$sum" ] && ok "a second run gives the same page" || fail "a second run gives the same page"
