#include "mocap/label_evidence.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/error.h"
#include "core/statistics.h"
#include "mocap/rigid_body.h"
#include "mocap/steady_markers.h"

namespace vultus::mocap {

namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr int kStep = 24;                // frames between those at which a long tracklet is looked at
constexpr double kNear = 80.0;           // mm
constexpr double kMemorySeconds = 0.25;  // for how long a marker's own past and future help to place it

}  // namespace

LabelEvidence::LabelEvidence(const Take& raw, double jump_mm)
    : raw_(raw), label_of_column_(raw.labels.size(), -1), row_of_(static_cast<std::size_t>(raw.frames()), -1) {
  for (int c = 0; c < raw.markers(); ++c) {
    if (is_unlabelled(raw.labels[static_cast<std::size_t>(c)])) continue;
    label_of_column_[static_cast<std::size_t>(c)] = labels();
    label_columns_.push_back(c);
  }
  for (const Tracklet& t : cut_tracklets(raw, jump_mm)) {
    tracklets_.push_back({t, label_of_column_[static_cast<std::size_t>(t.column)], true, 0.0});
  }
  to_head_coordinates();
  refresh();
  std::vector<int> learned(static_cast<std::size_t>(current_.frames()));
  std::iota(learned.begin(), learned.end(), 0);
  model_ = std::make_unique<MarkerModel>(current_, labels(), learned);
}

std::vector<int> LabelEvidence::looked_at(const Tracklet& t) const {
  std::vector<int> frames = {t.first};
  for (int f = (t.first / kStep + 1) * kStep; f < t.last; f += kStep) frames.push_back(f);
  if (frames.size() < 2 && t.frames() > 4) frames.push_back((t.first + t.last) / 2);
  if (t.last > t.first) frames.push_back(t.last);
  return frames;
}

void LabelEvidence::to_head_coordinates() {
  std::vector<std::uint8_t> wanted(row_of_.size(), 0);
  for (const int f : sampled_frames(raw_, 600)) wanted[static_cast<std::size_t>(f)] = 1;
  for (const LabelledTracklet& t : tracklets_)
    for (const int f : looked_at(t.span)) wanted[static_cast<std::size_t>(f)] = 1;
  const RigidBody body = find_steady_markers(raw_, central_frame(raw_, label_columns_), 6.0);
  const std::vector<int> columns = columns_of(raw_, body.labels);
  std::vector<std::optional<HeadPose>> poses(row_of_.size());
  tbb::parallel_for(0, raw_.frames(), [&](int f) {
    const auto i = static_cast<std::size_t>(f);
    if (wanted[i]) poses[i] = fit_body(body, observed_rows(raw_, f, columns));
  });
  int rows = 0;
  for (std::size_t f = 0; f < poses.size(); ++f)
    if (poses[f]) row_of_[f] = rows++;
  head_ = Take::empty(raw_.name, raw_.rate_hz, raw_.labels, rows);
  for (int f = 0; f < raw_.frames(); ++f) {
    if (row(f) < 0) continue;
    const Similarity head_from_world = poses[static_cast<std::size_t>(f)]->world_from_head.inverse();
    for (int c = 0; c < raw_.markers(); ++c)
      if (raw_.has(f, c)) head_.set(row(f), c, head_from_world * raw_.at(f, c));
  }
}

void LabelEvidence::refresh() {
  std::vector<std::string> names;
  for (int label = 0; label < labels(); ++label) names.push_back(name(label));
  current_ = Take::empty(raw_.name, raw_.rate_hz, std::move(names), head_.frames());
  by_label_.assign(static_cast<std::size_t>(labels()), {});
  for (std::size_t i = 0; i < tracklets_.size(); ++i) {
    const LabelledTracklet& t = tracklets_[i];
    if (t.label < 0) continue;
    for (int f = t.span.first; f <= t.span.last; ++f)
      if (row(f) >= 0) current_.set(row(f), t.label, place(t.span, f));
    if (t.trusted) by_label_[static_cast<std::size_t>(t.label)].push_back(static_cast<int>(i));
  }
  for (std::vector<int>& list : by_label_) {
    std::sort(list.begin(), list.end(), [&](int a, int b) {
      return tracklets_[static_cast<std::size_t>(a)].span.first < tracklets_[static_cast<std::size_t>(b)].span.first;
    });
  }
}

Eigen::Vector3d LabelEvidence::place(const Tracklet& t, int frame) const {
  if (row(frame) < 0) return Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  return head_.at(row(frame), t.column);
}

double LabelEvidence::misfit(const Tracklet& t, int label) const {
  std::vector<double> misses;
  for (const int f : looked_at(t)) {
    if (row(f) < 0) continue;
    if (const auto at = model_->predicted(current_, row(f), label)) misses.push_back((*at - place(t, f)).norm());
  }
  return misses.empty() ? kInf : median(std::move(misses));
}

LabelEvidence::Beside LabelEvidence::trusted_beside(const Tracklet& t, int label, int side) const {
  const std::vector<int>& own = by_label_[static_cast<std::size_t>(label)];
  const auto span = [&](int i) -> const Tracklet& { return tracklets_[static_cast<std::size_t>(i)].span; };
  const auto next = std::lower_bound(own.begin(), own.end(), t.first, [&](int i, int f) { return span(i).first < f; });
  int frame = -1;
  if (side < 0 && next != own.begin() && span(*(next - 1)).last < t.first) frame = span(*(next - 1)).last;
  if (side > 0) {
    const auto after = std::find_if(next, own.end(), [&](int i) { return span(i).first > t.last; });
    if (after != own.end()) frame = span(*after).first;
  }
  const int distance = side < 0 ? t.first - frame : frame - t.last;
  if (frame < 0 || distance > raw_.rate_hz || row(frame) < 0 || !current_.has(row(frame), label)) return {};
  const auto at = model_->predicted(current_, row(frame), label);
  return at ? Beside{frame, current_.at(row(frame), label) - *at} : Beside{};
}

double LabelEvidence::informed_misfit(const Tracklet& t, int label) const {
  const Beside before = trusted_beside(t, label, -1), after = trusted_beside(t, label, 1);
  const double memory = kMemorySeconds * raw_.rate_hz;
  std::vector<double> misses;
  for (const int f : looked_at(t)) {
    if (row(f) < 0) continue;
    const auto at = model_->predicted(current_, row(f), label);
    if (!at) continue;
    const double b = before.frame < 0 ? 0.0 : std::exp((before.frame - f) / memory);
    const double a = after.frame < 0 ? 0.0 : std::exp((f - after.frame) / memory);
    const Eigen::Vector3d offset = (b * before.offset + a * after.offset) / std::max(1.0, a + b);
    misses.push_back((*at + offset - place(t, f)).norm());
  }
  return misses.empty() ? kInf : median(std::move(misses));
}

double LabelEvidence::end_misfit(const Tracklet& t, int label) const {
  double least = kInf;
  for (const int side : {-1, 1}) {
    const int f = side < 0 ? t.first : t.last;
    const Beside beside = trusted_beside(t, label, side);
    if (beside.frame < 0 || std::abs(beside.frame - f) > kMemorySeconds * raw_.rate_hz || row(f) < 0) continue;
    const auto at = model_->predicted(current_, row(f), label);
    if (at) least = std::min(least, (*at + beside.offset - place(t, f)).norm());
  }
  return least;
}

bool LabelEvidence::is_near(const Tracklet& t, int label) const {
  for (const int f : {t.first, t.last}) {
    if ((place(t, f) - model_->mean(label)).norm() < kNear) return true;
  }
  return false;
}

}  // namespace vultus::mocap
