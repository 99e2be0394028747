#!/usr/bin/env bash
# Installs what is missing (Debian 12) and builds Vultus in release: apps/build.sh [CMAKE_OPTION…]
# VULTUS_BUILD names the build folder (build/release); VULTUS_NO_INSTALL=1 leaves the system as it is.
set -euo pipefail
top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=${VULTUS_BUILD:-$top/build/release}

packages="g++ cmake ninja-build ccache pkg-config libeigen3-dev libcgal-dev libopenmesh-dev libosd-dev libembree-dev
  libopenimageio-dev openimageio-tools libceres-dev libtbb-dev libopencv-core-dev libopencv-imgproc-dev
  libopencv-calib3d-dev libopencv-features2d-dev libopencv-video-dev libopencv-imgcodecs-dev libdlib-dev libdlib-data
  libcli11-dev nlohmann-json3-dev libspdlog-dev libssl-dev libgtest-dev libjs-dygraphs libjs-three ffmpeg"

installed() { dpkg-query -W -f='${Status}' "$1" 2>/dev/null | grep -q '^install ok installed$'; }

install_missing() {
  local missing=() package
  for package in $packages; do installed "$package" || missing+=("$package"); done
  [ ${#missing[@]} -gt 0 ] || return 0
  echo "installing: ${missing[*]}"
  local as_root=()
  [ "$(id -u)" = 0 ] || as_root=(sudo)
  "${as_root[@]}" apt-get update -q
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -qy --no-install-recommends "${missing[@]}"
}

# Some sources take 2.5 GB to compile.
jobs_for_memory() {
  local gigabytes cores
  gigabytes=$(awk '/MemAvailable/ {print int($2 / 1048576)}' /proc/meminfo)
  cores=$(nproc)
  local jobs=$((gigabytes * 2 / 5))
  [ "$jobs" -ge 1 ] || jobs=1
  [ "$jobs" -le "$cores" ] || jobs=$cores
  echo "$jobs"
}

[ -n "${VULTUS_NO_INSTALL:-}" ] || install_missing
cd "$top"
cmake --preset release -B "$build" "$@" >"${TMPDIR:-/tmp}/vultus-configure.$$" 2>&1 || {
  cat "${TMPDIR:-/tmp}/vultus-configure.$$"
  exit 1
}
rm -f "${TMPDIR:-/tmp}/vultus-configure.$$"
cmake --build "$build" --parallel "${VULTUS_JOBS:-$(jobs_for_memory)}"
