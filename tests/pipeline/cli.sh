#!/usr/bin/env bash
# The command line's manners: usage, bad input of every kind, output that cannot be written.
. "$(dirname "$0")/checks.bash"

# usage
expect "version" 0 "" "$vultus" --version
[[ $out == vultus\ [0-9]* ]] && ok "version on stdout" || fail "version on stdout: $out"
expect "no command" 1 "" "$vultus"
expect "unknown command" 1 'did you mean "onboard"' "$vultus" onbord
expect "unknown command of a group" 1 'did you mean "clean"' "$vultus" scan clena
expect "unknown option" 1 'did you mean "--actor"' "$vultus" onboard capture --actr a
expect "unknown option with a value" 1 'did you mean "--threads"' "$vultus" inspect x --thread=2
expect "unknown value" 1 'did you mean "qp"' "$vultus" session a --actor b --session c --solver qo
expect "a number that is none" 1 "--spp" "$vultus" render s --take t --spp many
expect "out of range" 1 "--spp" "$vultus" render s --take t --spp 0
expect "missing argument" 1 "" "$vultus" inspect
commands=$("$vultus" --help | sed -n '/^Subcommands:/,/^$/p' | awk 'NR > 1 && $1 {print $1}')
for command in $commands; do
  run "$vultus" "$command" --help
  [ "$status" = 0 ] && [ -n "$out" ] && [ -z "$err" ] || fail "$command --help: $status $err"
done
ok "every command has help"

# meshes
printf 'v 0 0 0\nv 100 0 0\nv 0 100 0\nf 1 2 3\n' >good.obj
: >empty.obj
printf 'v 0 0 0\nv 1 0' >truncated.obj
printf 'v 0 0 0\nv nan nan nan\nv 0 nan 0\nf 1 2 3\n' >nan.obj
printf 'PK\003\004 a zip' >wrong.obj
printf 'ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\nproperty float z\nend_header\n' >absurd.ply
head -c 84 /dev/zero | tr '\0' '\377' >absurd.stl
for file in empty.obj truncated.obj nan.obj wrong.obj absurd.ply absurd.stl missing.obj .; do
  expect "scan clean $file" 2 "$file" "$vultus" scan clean "$file" --out out.ply
  expect "register $file" 2 "$file" "$vultus" register "$file" --out out.obj
done
[ ! -e out.ply ] && [ ! -e out.obj ] && ok "bad meshes leave nothing" || fail "bad meshes leave nothing"

# takes
: >empty.c3d
printf 'hello' >wrong.c3d
head -c 2000 /dev/zero >zeros.c3d
printf 'PathFileType\t4\t(X/Y/Z)\tx.trc\n' >truncated.trc
printf 'frame,time\n' >empty.csv
for file in empty.c3d wrong.c3d zeros.c3d truncated.trc empty.csv missing.c3d .; do
  expect "mocap clean $file" 2 "$file" "$vultus" mocap clean "$file" --out out.c3d
done
[ ! -e out.c3d ] && ok "bad takes leave nothing" || fail "bad takes leave nothing"

# folders
mkdir -p nothing duplicate/scans unnamed/scans
cp good.obj unnamed/scans/nuetral.obj
cp good.obj duplicate/scans/neutral.obj
printf 'solid a\nendsolid a\n' >duplicate/scans/neutral.stl
expect "a capture without scans" 2 "nothing" "$vultus" onboard nothing --actor actor
expect "a capture without neutral" 2 '"nuetral"' "$vultus" onboard unnamed --actor actor
expect "two scans of one pose" 2 "neutral.obj and neutral.stl" "$vultus" onboard duplicate --actor actor
mkdir -p one/scans && cp good.obj one/scans/neutral.obj
expect "unknown pose" 1 'did you mean "neutral"' "$vultus" onboard one --actor actor --poses neutrl
expect "no actor" 2 "nothing" "$vultus" session good.obj --actor nothing --session session
expect "no session" 2 "nothing" "$vultus" render nothing --take t
expect "no databank" 2 "nothing" "$vultus" rig databank nothing --out databank
expect "nothing to inspect" 2 "nothing" "$vultus" inspect nothing
[ ! -e actor ] && [ ! -e session ] && ok "bad folders leave nothing" || fail "bad folders leave nothing: $(ls)"

# output
expect "data goes to stdout" 0 "" "$vultus" inspect good.obj
[[ $out == *'"vertices": 3'* ]] && ok "inspect tells of a mesh" || fail "inspect tells of a mesh: $out"
run sh -c "'$vultus' inspect good.obj >/dev/full"
[ "$status" = 4 ] && ok "stdout that takes nothing" || fail "stdout that takes nothing: $status"
expect "a report that cannot be written" 4 "/dev/full" "$vultus" inspect good.obj --json /dev/full
[ -c /dev/full ] && ok "devices stay devices" || fail "devices stay devices"
expect "output below a file" 4 "good.obj" "$vultus" inspect good.obj --json good.obj/report.json
"$vultus" inspect good.obj --json report.json >/dev/null 2>&1
grep -q '"exit_code": 0' report.json && grep -q '"command": "inspect"' report.json && ok "the report" || fail "the report"
"$vultus" inspect empty.obj --json failed.json >/dev/null 2>&1
grep -q '"exit_code": 2' failed.json && grep -q 'empty.obj' failed.json && ok "a report of failure" || fail "a report of failure"

# A limit on file sizes makes write() fail midway, as a full disk does.
mkdir full
awk 'BEGIN {
  n = 120
  for (i = 0; i < n; i++) for (j = 0; j < n; j++) print "v", i, j, 5 * sin(i / 20) * sin(j / 20)
  for (i = 1; i < n; i++) for (j = 1; j < n; j++) { a = (i - 1) * n + j; print "f", a, a + 1, a + n + 1, a + n }
}' >sheet.obj
run bash -c "trap '' XFSZ; ulimit -f 8; exec '$vultus' scan clean sheet.obj --mm-per-unit 1 --out full/clean.ply"
[ "$status" = 4 ] && [[ $err == *clean.ply* ]] && ok "a full disk" || fail "a full disk: $status $err"
[ -z "$(ls -A full)" ] && ok "a full disk leaves nothing half-written" || fail "left on the full disk: $(ls -A full)"

# permissions
as_nobody() { if [ "$(id -u)" = 0 ]; then setpriv --reuid 65534 --regid 65534 --clear-groups -- "$@"; else "$@"; fi; }
chmod 755 "$work"
mkdir -p locked && cp good.obj secret.obj && chmod 000 secret.obj && chmod 555 locked
if as_nobody "$vultus" --version >/dev/null 2>&1; then
  expect "no permission to read" 2 "secret.obj" as_nobody "$vultus" inspect secret.obj
  expect "no permission to write" 4 "locked" as_nobody "$vultus" inspect good.obj --json locked/report.json
else
  skip "permissions: cannot become another user"
fi
exit $bad
