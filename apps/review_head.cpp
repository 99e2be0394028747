#include "apps/review_head.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/review_encoding.h"
#include "core/array_io.h"
#include "core/error.h"
#include "core/texture_space.h"

namespace vultus::apps {
namespace {

constexpr double kDistanceStep = 0.001;  // mm; 16 bits reach 65 mm
constexpr double kStill = 0.01;          // mm; less motion than this cannot be seen and is not stored

/// The vertices that take part in the page and their new numbers.
struct VisiblePart {
  std::vector<int> vertices;   // in the actor's topology
  std::vector<int> number;     // of each vertex of the topology; -1 where left out
  std::vector<int> triangles;  // of the topology's triangulated view
};

VisiblePart visible_part(const Topology& topology) {
  std::vector<bool> hidden(topology.vertex_count(), false);
  if (topology.has_set("hidden")) {
    for (int v : topology.set("hidden")) hidden[v] = true;
  }
  VisiblePart part;
  std::vector<bool> used(topology.vertex_count(), false);
  const Triangles& triangles = topology.triangles();
  for (int t = 0; t < triangles.rows(); ++t) {
    if (hidden[triangles(t, 0)] || hidden[triangles(t, 1)] || hidden[triangles(t, 2)]) continue;
    part.triangles.push_back(t);
    for (int corner = 0; corner < 3; ++corner) used[triangles(t, corner)] = true;
  }
  part.number.assign(topology.vertex_count(), -1);
  for (int v = 0; v < topology.vertex_count(); ++v) {
    if (!used[v]) continue;
    part.number[v] = static_cast<int>(part.vertices.size());
    part.vertices.push_back(v);
  }
  return part;
}

nlohmann::json triangles_json(const Topology& topology, const VisiblePart& part) {
  std::vector<std::uint32_t> corners;
  for (int t : part.triangles) {
    for (int corner = 0; corner < 3; ++corner) {
      corners.push_back(static_cast<std::uint32_t>(part.number[topology.triangles()(t, corner)]));
    }
  }
  if (part.vertices.size() > 65535) return {{"bytes", 4}, {"data", base64(std::span<const std::uint32_t>(corners))}};
  const std::vector<std::uint16_t> small(corners.begin(), corners.end());
  return {{"bytes", 2}, {"data", base64(std::span<const std::uint16_t>(small))}};
}

std::int16_t rounded(double value) {
  return static_cast<std::int16_t>(std::clamp(std::round(value), -32767.0, 32767.0));
}

nlohmann::json neutral_json(const rig::Actor& actor, const VisiblePart& part) {
  const Box box = bounds(actor.neutral());
  const double step = (box.max - box.min).maxCoeff() / 2.0 / 32767.0;
  std::vector<std::int16_t> values;
  for (int v : part.vertices) {
    for (int axis = 0; axis < 3; ++axis) {
      values.push_back(rounded((actor.neutral()(v, axis) - box.centre()[axis]) / step));
    }
  }
  return {{"step", step},
          {"centre", {box.centre().x(), box.centre().y(), box.centre().z()}},
          {"data", base64(std::span<const std::int16_t>(values))}};
}

nlohmann::json pose_json(const rig::Actor& actor, const rig::Pose& pose, const VisiblePart& part) {
  const Points motion = pose.positions - actor.neutral();
  const double step = std::max(motion.cwiseAbs().maxCoeff() / 32767.0, 1e-6);
  std::vector<std::uint32_t> moved;
  std::vector<std::int16_t> values;
  for (std::size_t i = 0; i < part.vertices.size(); ++i) {
    const auto row = motion.row(part.vertices[i]);
    if (row.norm() < kStill) continue;
    moved.push_back(static_cast<std::uint32_t>(i));
    for (int axis = 0; axis < 3; ++axis) values.push_back(rounded(row[axis] / step));
  }
  return {{"name", pose.name},
          {"step", step},
          {"vertices", base64(std::span<const std::uint32_t>(moved))},
          {"motion", base64(std::span<const std::int16_t>(values))}};
}

std::string masks_of(const rig::Actor& actor, const VisiblePart& part) {
  std::vector<std::uint8_t> values;
  for (int v : part.vertices) {
    for (const rig::Region& region : actor.regions) {
      values.push_back(static_cast<std::uint8_t>(std::lround(255.0F * std::clamp(region.vertex_mask[v], 0.0F, 1.0F))));
    }
  }
  return base64(std::span<const std::uint8_t>(values));
}

nlohmann::json distances_json(const ReviewSession& session, const VisiblePart& part) {
  nlohmann::json result = nlohmann::json::object();
  for (const rig::Pose& pose : session.actor.poses) {
    const auto file = session.actor_folder / "report" / (pose.name + ".distance.npy");
    if (!std::filesystem::exists(file)) continue;
    const Array array = read_npy(file);
    if (array.size() != static_cast<std::size_t>(session.actor.topology->vertex_count())) {
      throw InputError(file, "must have one value for each of the actor's vertices");
    }
    std::vector<float> values;
    for (int v : part.vertices) values.push_back(std::abs(array.values[v]));
    result[pose.name] = base64(std::span<const std::uint16_t>(quantized(values, kDistanceStep)));
  }
  return result;
}

nlohmann::json colours_json(const rig::Actor& actor, const VisiblePart& part) {
  if (actor.albedo.empty() || actor.albedo.channels() < 3 || !actor.topology->has_uvs()) return nullptr;
  const Uvs uvs = TextureSpace(actor.topology, 16, 16).vertex_uvs();
  std::vector<std::uint8_t> values;
  for (int v : part.vertices) {
    for (int channel = 0; channel < 3; ++channel) {
      const float linear =
          actor.albedo.sample(uvs(v, 0) * actor.albedo.width(), (1.0 - uvs(v, 1)) * actor.albedo.height(), channel);
      values.push_back(
          static_cast<std::uint8_t>(std::lround(255.0F * std::clamp(srgb_from_linear(linear), 0.0F, 1.0F))));
    }
  }
  return base64(std::span<const std::uint8_t>(values));
}

nlohmann::json markers_json(const ReviewSession& session, const VisiblePart& part) {
  nlohmann::json result = nlohmann::json::array();
  const Triangles& triangles = session.actor.topology->triangles();
  for (const auto& [label, place] : session.markers) {
    nlohmann::json corners = nlohmann::json::array();
    bool visible = true;
    for (int corner = 0; corner < 3; ++corner) {
      const int number = part.number[triangles(place.triangle, corner)];
      visible = visible && number >= 0;
      corners.push_back(number);
    }
    if (!visible) continue;
    const Eigen::Vector3d& b = place.barycentric;
    result.push_back({{"label", label}, {"vertices", corners}, {"barycentric", {b.x(), b.y(), b.z()}}});
  }
  return result;
}

}  // namespace

nlohmann::json head_json(const ReviewSession& session) {
  const rig::Actor& actor = session.actor;
  const VisiblePart part = visible_part(*actor.topology);
  nlohmann::json head;
  head["vertices"] = part.vertices.size();
  head["triangles"] = triangles_json(*actor.topology, part);
  head["neutral"] = neutral_json(actor, part);
  head["poses"] = nlohmann::json::array();
  for (const rig::Pose& pose : actor.poses) head["poses"].push_back(pose_json(actor, pose, part));
  head["regions"] = nlohmann::json::array();
  for (const rig::Region& region : actor.regions) head["regions"].push_back(region.name);
  head["masks"] = masks_of(actor, part);
  head["distance_step"] = kDistanceStep;
  head["distances"] = distances_json(session, part);
  head["colours"] = colours_json(actor, part);
  head["markers"] = markers_json(session, part);
  return head;
}

}  // namespace vultus::apps
