# What the pipeline tests share. Each check prints one line that begins with "ok", "FAILED" or "skipped"; tests/run.sh
# counts them.
top=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
vultus=${VULTUS_BUILD:-$top/build/release}/apps/vultus
[ -x "$vultus" ] || { echo "FAILED $vultus is not built"; exit 1; }
work=$(mktemp -d)
trap 'chmod -R u+rwX "$work" 2>/dev/null; rm -rf "$work"' EXIT
cd "$work" || exit 1
bad=0

ok() { echo "ok $1"; }
fail() { echo "FAILED $1"; bad=1; }
skip() { echo "skipped $1"; }

# run COMMAND…: leaves its output in $out and $err (texts) and its status in $status.
run() {
  "$@" >"$work/.out" 2>"$work/.err"
  status=$?
  out=$(cat "$work/.out") err=$(cat "$work/.err")
}

# expect NAME STATUS TEXT COMMAND…: the command must end with the status and say TEXT on stderr (a fixed string).
expect() {
  local name=$1 wanted=$2 text=$3
  shift 3
  run "$@"
  if [ "$status" != "$wanted" ]; then
    fail "$name: status $status, expected $wanted: $err"
  elif [ -n "$text" ] && ! grep -qF -- "$text" <<<"$err"; then
    fail "$name: stderr lacks \"$text\": $err"
  else
    ok "$name"
  fi
}

# same NAME A B: equal files or folders (recursively).
same() { if diff -rq "$2" "$3" >"$work/.diff"; then ok "$1"; else fail "$1: $(head -n 3 "$work/.diff")"; fi; }
