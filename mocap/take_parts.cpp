#include "mocap/take_parts.h"

#include <algorithm>
#include <numeric>

namespace vultus::mocap {

namespace {

/// `values` in blocks of `width`, each kept where `keep`, counted round, says so: blocks only move towards the front.
template <class T>
void keep_blocks(const std::vector<std::uint8_t>& keep, std::size_t width, std::vector<T>& values) {
  std::size_t to = 0;
  for (std::size_t from = 0, block = 0; from < values.size(); from += width, ++block) {
    if (keep[block % keep.size()] == 0) continue;
    if (to != from) std::copy_n(values.data() + from, width, values.data() + to);
    to += width;
  }
  values.resize(to);
}

}  // namespace

void keep_frames(const std::vector<std::uint8_t>& keep, Take& take) {
  if (take.file_frames.empty()) {
    take.file_frames.resize(keep.size());
    std::iota(take.file_frames.begin(), take.file_frames.end(), 0);
  }
  const std::size_t n = take.labels.size();
  keep_blocks(keep, 3 * n, take.positions);
  keep_blocks(keep, n, take.present);
  keep_blocks(keep, n, take.residuals);
  keep_blocks(keep, n, take.cameras);
  keep_blocks(keep, 1, take.file_frames);
}

void keep_markers(const std::vector<std::uint8_t>& keep, Take& take) {
  keep_blocks(keep, 3, take.positions);
  keep_blocks(keep, 1, take.present);
  keep_blocks(keep, 1, take.residuals);
  keep_blocks(keep, 1, take.cameras);
  keep_blocks(keep, 1, take.labels);
}

Take emptied(const Take& take, std::vector<std::string> labels) {
  Take result = Take::empty(take.name, take.rate_hz, std::move(labels), take.frames());
  result.residual_step = take.residual_step;
  result.first_frame = take.first_frame;
  result.file_frames = take.file_frames;
  result.events = take.events;
  result.decisions = take.decisions;
  if (!take.residuals.empty()) result.residuals.assign(result.present.size(), 0.0F);
  if (!take.cameras.empty()) result.cameras.assign(result.present.size(), 0);
  return result;
}

void copy_sample(const Take& from, std::size_t i, Take& to, std::size_t j) {
  std::copy_n(from.positions.data() + 3 * i, 3, to.positions.data() + 3 * j);
  to.present[j] = from.present[i];
  if (!from.residuals.empty()) to.residuals[j] = from.residuals[i];
  if (!from.cameras.empty()) to.cameras[j] = from.cameras[i];
}

}  // namespace vultus::mocap
