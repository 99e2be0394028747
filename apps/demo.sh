#!/usr/bin/env bash
# From a bare Debian 12 to a review page: installs what is missing, builds, and runs the demo.
#   apps/demo.sh [DIR]      DIR defaults to demo-out
set -euo pipefail
top=$(cd "$(dirname "$0")/.." && pwd)
out=$(realpath -m "${1:-demo-out}")
"$top/apps/build.sh" -DVULTUS_TESTS=OFF
"${VULTUS_BUILD:-$top/build/release}/apps/vultus" demo "$out" || [ $? = 5 ] # 5: finished, some scan below the asked quality, as the page says
echo "open $out/session/review/index.html in a browser"
