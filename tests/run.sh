#!/usr/bin/env bash
# Installs what is missing, builds with warnings as errors, and runs every test: tests/run.sh
#   VULTUS_DATA=DIR   an unpacked copy of the real data; else ../shared/data is unpacked to build/data where it exists,
#                     and tests that need it are reported as skipped elsewhere
set -uo pipefail
top=$(cd "$(dirname "$0")/.." && pwd)
export VULTUS_BUILD=${VULTUS_BUILD:-$top/build/release}
"$top/apps/build.sh" -DVULTUS_TESTS=ON || { echo "0 passed, 1 failed, 0 skipped"; exit 1; }

archives=$top/../shared/data
if [ -z "${VULTUS_DATA:-}" ] && [ -f "$archives/unpack.sh" ]; then
  sh "$archives/unpack.sh" "$top/build/data" && export VULTUS_DATA=$top/build/data
fi

reports=$VULTUS_BUILD/test-reports
rm -rf "$reports"
mkdir -p "$reports"
export GTEST_OUTPUT=xml:$reports/
passed=0 failed=0 skipped=0

# Every program of unit tests is one entry of ctest and counts its own cases.
ctest --test-dir "$VULTUS_BUILD" --parallel "$(nproc)" --output-on-failure --no-tests=error
attribute() { sed -n "s/^<testsuites .*\\b$1=\"\\([0-9]*\\)\".*/\\1/p" "$2"; }
for program in "$VULTUS_BUILD"/tests/unit_*; do
  [ -x "$program" ] && [ -f "$program" ] || continue
  report=$reports/$(basename "$program").xml
  if [ ! -s "$report" ]; then  # it died before its report
    echo "FAILED: $(basename "$program") ended without a report"
    failed=$((failed + 1))
    continue
  fi
  cases=$(attribute tests "$report") bad=$(attribute failures "$report") errors=$(attribute errors "$report")
  skips=$(grep -c 'result="skipped"' "$report" || true)
  failed=$((failed + bad + errors))
  skipped=$((skipped + skips))
  passed=$((passed + cases - bad - errors - skips))
done
unset GTEST_OUTPUT

# Pipeline tests drive the binary; each prints "ok", "FAILED" or "skipped" a check.
for script in "$top"/tests/pipeline/*.sh; do
  log=$reports/$(basename "$script" .sh).log
  echo "== $(basename "$script")"
  bash "$script" 2>&1 | tee "$log" | grep -E '^(FAILED|skipped)|^ ' || true
  checks=$(grep -c '^ok ' "$log" || true) bad=$(grep -c '^FAILED ' "$log" || true) skips=$(grep -c '^skipped ' "$log" || true)
  [ $((checks + bad + skips)) -gt 0 ] || { bad=1; cat "$log"; }
  passed=$((passed + checks)) failed=$((failed + bad)) skipped=$((skipped + skips))
done

echo "== real.sh"
VULTUS_REAL=quick bash "$top/tests/real.sh" "$VULTUS_BUILD/real" >"$reports/real.log" 2>&1
case $? in
  0) passed=$((passed + 1)) ;;
  77) skipped=$((skipped + 1)); tail -n 1 "$reports/real.log" ;;
  *) failed=$((failed + 1)); echo "FAILED real.sh"; tail -n 30 "$reports/real.log" ;;
esac

echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
