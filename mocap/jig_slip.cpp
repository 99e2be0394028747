#include "mocap/jig_slip.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/error.h"
#include "core/statistics.h"

namespace vultus::mocap {

namespace {

constexpr std::size_t kLeastBlocks = 3;  // on each side of a slip

/// Where a marker is on the body during a tenth of a second.
struct Block {
  int first = 0, last = 0;  // frames
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
};

class Path {
 public:
  Path(const Take& take, const std::vector<HeadPose>& poses, int column)
      : take_(take), poses_(poses), column_(column) {}

  std::optional<Eigen::Vector3d> at(int frame) const {
    const HeadPose& pose = poses_[static_cast<std::size_t>(frame)];
    if (pose.kind != HeadPose::Kind::measured || !take_.has(frame, column_)) return {};
    return pose.world_from_head.inverse() * take_.at(frame, column_);
  }

  std::vector<Block> blocks() const {
    const int length = std::max(1, static_cast<int>(0.1 * take_.rate_hz));
    std::vector<Block> result;
    for (int first = 0; first < take_.frames(); first += length) {
      const int last = std::min(first + length, take_.frames()) - 1;
      std::array<std::vector<double>, 3> values;
      for (int f = first; f <= last; ++f) {
        const auto place = at(f);
        for (int c = 0; place && c < 3; ++c) values[static_cast<std::size_t>(c)].push_back((*place)[c]);
      }
      if (2 * static_cast<int>(values[0].size()) < last - first + 1) continue;
      Block block{first, last, Eigen::Vector3d::Zero()};
      for (int c = 0; c < 3; ++c) block.place[c] = median(std::move(values[static_cast<std::size_t>(c)]));
      result.push_back(block);
    }
    return result;
  }

 private:
  const Take& take_;
  const std::vector<HeadPose>& poses_;
  int column_;
};

Eigen::Vector3d median_place(const std::vector<Block>& blocks, std::size_t first, std::size_t end) {
  Eigen::Vector3d result;
  for (int c = 0; c < 3; ++c) {
    std::vector<double> values;
    for (std::size_t i = first; i < end; ++i) values.push_back(blocks[i].place[c]);
    result[c] = median(std::move(values));
  }
  return result;
}

double scatter_about(const std::vector<Block>& blocks, std::size_t first, std::size_t end,
                     const Eigen::Vector3d& place) {
  std::vector<double> distances;
  for (std::size_t i = first; i < end; ++i) distances.push_back((blocks[i].place - place).norm());
  return quantile(std::move(distances), 0.7);
}

/// The cut of [first, end) that leaves the least sum of squares about the two means.
std::size_t best_cut(const std::vector<Block>& blocks, std::size_t first, std::size_t end) {
  Eigen::Vector3d total = Eigen::Vector3d::Zero(), before = Eigen::Vector3d::Zero();
  for (std::size_t i = first; i < end; ++i) total += blocks[i].place - blocks[first].place;
  std::size_t best = first;
  double most = -1.0;
  for (std::size_t i = first + 1; i < end; ++i) {
    before += blocks[i - 1].place - blocks[first].place;
    const auto left = static_cast<double>(i - first), right = static_cast<double>(end - i);
    if (i - first < kLeastBlocks || end - i < kLeastBlocks) continue;
    const double between = left * right * (before / left - (total - before) / right).squaredNorm();
    if (between > most) {
      most = between;
      best = i;
    }
  }
  return best;
}

/// The earliest slip among the blocks [first, end): cuts until no half can be cut further, from the left.
std::optional<std::pair<std::size_t, double>> first_slip(const std::vector<Block>& blocks, std::size_t first,
                                                         std::size_t end, const SlipOptions& options) {
  if (end - first < 2 * kLeastBlocks) return {};
  const std::size_t cut = best_cut(blocks, first, end);
  if (cut == first) return {};
  const Eigen::Vector3d before = median_place(blocks, first, cut), after = median_place(blocks, cut, end);
  const double distance = (after - before).norm();
  const double scatter = std::max(scatter_about(blocks, first, cut, before), scatter_about(blocks, cut, end, after));
  const bool slipped = distance > std::max(options.least_mm, options.factor * scatter);
  if (slipped || distance > options.least_mm) {
    // A half that itself holds a slip spoils the scatter of the whole, so both are looked at.
    if (const auto earlier = first_slip(blocks, first, cut, options)) return earlier;
  }
  if (slipped) return std::pair{cut, distance};
  return distance > options.least_mm ? first_slip(blocks, cut, end, options) : std::nullopt;
}

/// First frame near the cut from which on the marker stays away from its old place, further than single frames usually
/// are (three in a row, since one may be back by chance).
int moment_of(const Path& path, const std::vector<Block>& blocks, std::size_t cut, const Eigen::Vector3d& old) {
  const std::size_t from = cut >= 2 * kLeastBlocks ? cut - 2 * kLeastBlocks : 0;
  std::vector<double> usual;
  for (int f = blocks[0].first; f < blocks[from].last; ++f) {
    if (const auto place = path.at(f)) usual.push_back((*place - old).norm());
  }
  const double limit = usual.empty() ? 0.0 : quantile(std::move(usual), 0.9);
  int frame = blocks[cut].last, back = 0;
  for (int f = blocks[cut].last; f >= blocks[from].first && back < 3; --f) {
    const auto place = path.at(f);
    if (!place) continue;
    back = (*place - old).norm() < limit ? back + 1 : 0;
    if (back == 0) frame = f;
  }
  return frame;
}

/// First frame from which the marker rests at a new place: three tenths of a second in a row near their common median.
int settled_at(const std::vector<Block>& blocks, std::size_t cut, double least_mm) {
  for (std::size_t i = cut; i + kLeastBlocks <= blocks.size(); ++i) {
    const std::size_t end = std::min(blocks.size(), i + 10);
    const Eigen::Vector3d place = median_place(blocks, i, end);
    bool rests = true;
    for (std::size_t k = i; k < i + kLeastBlocks; ++k)
      rests = rests && (blocks[k].place - place).norm() < 0.5 * least_mm;
    if (rests) return blocks[i].first;
  }
  return -1;
}

std::optional<JigSlip> slip_of(const Take& take, const RigidBody& body, int row, const std::vector<HeadPose>& poses,
                               bool known_place, const SlipOptions& options) {
  const std::string& label = body.labels[static_cast<std::size_t>(row)];
  const int column = take.find(label);
  if (column < 0) return {};
  const Path path(take, poses, column);
  const std::vector<Block> blocks = path.blocks();
  if (blocks.size() < kLeastBlocks) return {};
  const auto slip = first_slip(blocks, 0, blocks.size(), options);
  const std::size_t end = slip ? slip->first : blocks.size();
  const Eigen::Vector3d place = median_place(blocks, 0, end);
  if (known_place) {
    const double away = (place - Eigen::Vector3d(body.positions.row(row))).norm();
    const double limit = std::max(options.least_mm, options.factor * std::min(0.2, body.deviations(row)));
    if (away > limit) return JigSlip{label, 0, settled_at(blocks, 0, options.least_mm), away};
  }
  if (!slip) return {};
  return JigSlip{label, moment_of(path, blocks, slip->first, place), settled_at(blocks, slip->first, options.least_mm),
                 slip->second};
}

}  // namespace

void SlipOptions::validate() const {
  if (!(least_mm > 0.0)) throw UsageError("least_mm of a slip must be positive");
  if (!(factor > 1.0)) throw UsageError("factor of a slip must be above 1");
}

std::vector<JigSlip> find_slips(const Take& take, const RigidBody& body, const std::vector<HeadPose>& poses,
                                bool known_places, const SlipOptions& options) {
  options.validate();
  const auto rows = static_cast<int>(body.positions.rows());
  std::vector<std::optional<JigSlip>> found(static_cast<std::size_t>(rows));
  tbb::parallel_for(0, rows, [&](int row) {
    if (body.positions.row(row).allFinite()) {
      found[static_cast<std::size_t>(row)] = slip_of(take, body, row, poses, known_places, options);
    }
  });
  std::vector<JigSlip> slips;
  for (const auto& slip : found)
    if (slip) slips.push_back(*slip);
  std::stable_sort(slips.begin(), slips.end(), [](const JigSlip& a, const JigSlip& b) { return a.frame < b.frame; });
  return slips;
}

Take without_slipped(const Take& take, const std::vector<JigSlip>& slips) {
  Take result = take;
  for (const JigSlip& slip : slips) {
    const int column = take.find(slip.label);
    for (int f = slip.frame; column >= 0 && f < take.frames(); ++f) result.drop(f, column);
  }
  return result;
}

}  // namespace vultus::mocap
