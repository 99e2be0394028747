#include "rig/blendshapes.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>

#include "core/error.h"
#include "core/files.h"

namespace vultus::rig {
namespace {

constexpr int kBlock = Blendshapes::block;
constexpr float kStill = 1e-6F;  // mm: below the resolution of float positions

// The wide build has no fused multiply-add, so that every machine gives the same bytes.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define VULTUS_WIDE __attribute__((target_clones("avx2", "default")))
#else
#define VULTUS_WIDE
#endif

/// y += a·x over one block.
VULTUS_WIDE void add_scaled(float a, const float* x, float* y) {
  for (int i = 0; i < kBlock; ++i) y[i] += a * x[i];
}

/// y += c·x over one block.
VULTUS_WIDE void add_product(const float* c, const float* x, float* y) {
  for (int i = 0; i < kBlock; ++i) y[i] += c[i] * x[i];
}

std::vector<int> pose_indices(const Actor& actor, const std::vector<std::string>& names) {
  std::vector<int> indices;
  for (const std::string& name : names) indices.push_back(actor.pose_index(name));
  return indices;
}

std::vector<const Eigen::VectorXf*> masks_of(const Actor& actor, const std::vector<std::string>& names) {
  std::vector<const Eigen::VectorXf*> masks;
  std::vector<std::string> known;
  for (const Region& region : actor.regions) known.push_back(region.name);
  for (const std::string& name : names) {
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end()) {
      const std::string nearest = nearest_name(name, known);
      throw InputError("actor \"" + actor.name + "\" has no region \"" + name + "\"" +
                       (nearest.empty() ? std::string() : "; did you mean \"" + nearest + "\"?"));
    }
    masks.push_back(&actor.regions[static_cast<std::size_t>(found - known.begin())].vertex_mask);
  }
  return masks;
}

}  // namespace

Blendshapes::Blendshapes(const Actor& actor, const std::vector<std::string>& poses,
                         const std::vector<std::string>& regions)
    : vertices_(actor.topology->vertex_count()),
      pose_count_(poses.size()),
      region_count_(std::max<std::size_t>(regions.size(), 1)) {
  const std::vector<int> indices = pose_indices(actor, poses);
  const std::vector<const Eigen::VectorXf*> masks = masks_of(actor, regions);
  const int blocks = (vertices_ + kBlock - 1) / kBlock;
  rest_.assign(static_cast<std::size_t>(blocks) * 3 * kBlock, 0.0F);
  block_shifts_.resize(blocks);
  block_masks_.resize(blocks);
  for (int b = 0; b < blocks; ++b) {
    const int first = b * kBlock, count = std::min(kBlock, vertices_ - first);
    for (int i = 0; i < count; ++i)
      for (int axis = 0; axis < 3; ++axis)
        rest_[(static_cast<std::size_t>(b) * 3 + axis) * kBlock + i] =
            static_cast<float>(actor.neutral()(first + i, axis));
    for (std::size_t p = 0; p < indices.size(); ++p) {
      const Points& pose = actor.poses[indices[p]].positions;
      std::array<float, 3 * kBlock> planes{};
      for (int i = 0; i < count; ++i)
        for (int axis = 0; axis < 3; ++axis)
          planes[static_cast<std::size_t>(axis * kBlock + i)] =
              static_cast<float>(pose(first + i, axis) - actor.neutral()(first + i, axis));
      if (std::none_of(planes.begin(), planes.end(), [](float d) { return std::abs(d) > kStill; })) continue;
      block_shifts_[b].push_back({static_cast<int>(p), shifts_.size()});
      shifts_.insert(shifts_.end(), planes.begin(), planes.end());
    }
    for (std::size_t r = 0; r < region_count_; ++r) {
      std::array<float, kBlock> mask{};
      for (int i = 0; i < count; ++i) mask[static_cast<std::size_t>(i)] = masks.empty() ? 1.0F : (*masks[r])[first + i];
      if (std::none_of(mask.begin(), mask.end(), [](float m) { return m != 0.0F; })) continue;
      block_masks_[b].push_back({static_cast<int>(r), masks_.size()});
      masks_.insert(masks_.end(), mask.begin(), mask.end());
    }
  }
}

void Blendshapes::blend_block(int number, std::span<const float> weights, std::span<float> positions) const {
  alignas(32) std::array<float, kBlock> factor{};
  alignas(32) std::array<float, 3 * kBlock> sum{};
  // Σ_p w_kp S_p = (Σ_p w_kp) rest + Σ_p w_kp (S_p − rest), region by region.
  for (const Mask& mask : block_masks_[number]) {
    float total = 0.0F;
    for (std::size_t p = 0; p < pose_count_; ++p) total += weights[mask.region * pose_count_ + p];
    add_scaled(total, &masks_[mask.offset], factor.data());
  }
  for (int axis = 0; axis < 3; ++axis)
    add_product(factor.data(), &rest_[(static_cast<std::size_t>(number) * 3 + axis) * kBlock], &sum[axis * kBlock]);
  for (const Shift& shift : block_shifts_[number]) {
    factor.fill(0.0F);
    bool used = false;
    for (const Mask& mask : block_masks_[number]) {
      const float weight = weights[mask.region * pose_count_ + shift.pose];
      if (weight == 0.0F) continue;
      add_scaled(weight, &masks_[mask.offset], factor.data());
      used = true;
    }
    if (!used) continue;
    for (int axis = 0; axis < 3; ++axis)
      add_product(factor.data(), &shifts_[shift.offset + axis * kBlock], &sum[axis * kBlock]);
  }
  const int first = number * kBlock, count = std::min(kBlock, vertices_ - first);
  for (int i = 0; i < count; ++i)
    for (int axis = 0; axis < 3; ++axis)
      positions[static_cast<std::size_t>(first + i) * 3 + axis] = sum[axis * kBlock + i];
}

void Blendshapes::blend(std::span<const float> weights, std::span<float> positions) const {
  if (weights.size() != pose_count_ * region_count_)
    throw InputError("blending " + std::to_string(region_count_) + " regions × " + std::to_string(pose_count_) +
                     " poses needs as many weights, not " + std::to_string(weights.size()));
  if (positions.size() != static_cast<std::size_t>(vertices_) * 3)
    throw InputError("blending needs room for " + std::to_string(vertices_) + " vertices");
  tbb::parallel_for(0, static_cast<int>(block_shifts_.size()), [&](int b) { blend_block(b, weights, positions); });
}

FloatPoints Blendshapes::operator()(std::span<const float> weights) const {
  FloatPoints positions(vertices_, 3);
  blend(weights, {positions.data(), static_cast<std::size_t>(positions.size())});
  return positions;
}

}  // namespace vultus::rig
