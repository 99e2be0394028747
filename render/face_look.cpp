#include "render/face_look.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "core/neighbours.h"

namespace vultus::render {
namespace {

struct Substance {
  Eigen::RowVector3d colour;
  Finish finish;
};

const Substance skin{{0.57, 0.365, 0.275}, {0.52f, 1.4f, 0.9f}};
const Substance lips{{0.46, 0.205, 0.175}, {0.36f, 1.4f, 1.0f}};
const Substance sclera{{0.70, 0.66, 0.62}, {0.08f, 1.376f, 1.0f}};  // 1.376: the cornea's index
const Substance teeth{{0.66, 0.60, 0.48}, {0.22f, 1.5f, 1.0f}};
const Substance mouth{{0.36, 0.11, 0.10}, {0.25f, 1.35f, 1.0f}};
const Substance caruncle{{0.52, 0.24, 0.21}, {0.2f, 1.35f, 1.0f}};

const std::pair<std::string_view, const Substance*> by_prefix[] = {
    {"teeth", &teeth},        {"gums", &mouth},         {"tongue", &mouth},      {"inner_mouth", &mouth},
    {"mouth_cavity", &mouth}, {"mouth_socket", &mouth}, {"lacrimal", &caruncle}, {"eyeball", &sclera}};

const std::string_view hidden_prefixes[] = {"eye_occlusion", "eye_blend", "eyelashes"};

/// 1 in the set, 0 far from it, falling off over a few edges.
std::vector<double> softened(const std::vector<int>& set, const Topology& topology) {
  const Adjacency neighbours = adjacency(topology);
  std::vector<double> value(topology.vertex_count(), 0.0), next;
  for (const int v : set) value[v] = 1.0;
  constexpr int rounds = 3;
  for (int round = 0; round < rounds; ++round) {
    next = value;
    for (int v = 0; v < topology.vertex_count(); ++v) {
      const auto near = neighbours.of(v);
      if (near.empty()) continue;
      double mean = 0.0;
      for (const int n : near) mean += value[n] / static_cast<double>(near.size());
      next[v] = 0.5 * value[v] + 0.5 * mean;
    }
    value.swap(next);
  }
  return value;
}

Finish mix(const Finish& a, const Finish& b, float t) {
  return {a.roughness + (b.roughness - a.roughness) * t, a.ior + (b.ior - a.ior) * t,
          a.specular + (b.specular - a.specular) * t};
}

double smooth_step(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

/// Iris and pupil by the angle from +z about the eyeball's centre: an iris 11.8 mm wide on a ball 24 mm wide.
void paint_eye(const std::vector<int>& eyeball, const Points& neutral, Points& colours) {
  if (eyeball.empty()) return;
  Eigen::RowVector3d low = neutral.row(eyeball.front()), high = low;
  for (const int v : eyeball) {
    low = low.cwiseMin(neutral.row(v));
    high = high.cwiseMax(neutral.row(v));
  }
  const Eigen::RowVector3d pupil(0.006, 0.006, 0.006), iris(0.10, 0.065, 0.035), limbus(0.035, 0.025, 0.02);
  // A ball that is open behind has its centre half a width behind its front.
  Eigen::RowVector3d centre = 0.5 * (low + high);
  centre.z() = high.z() - 0.5 * std::max(high.x() - low.x(), high.y() - low.y());
  for (const int v : eyeball) {
    const Eigen::RowVector3d offset = neutral.row(v) - centre;
    const double degrees = std::atan2(std::hypot(offset.x(), offset.y()), offset.z()) * 57.29577951308232;
    const double to_iris = smooth_step(9.0, 12.0, degrees), to_limbus = smooth_step(21.0, 28.0, degrees);
    const double to_white = smooth_step(28.0, 33.0, degrees);
    Eigen::RowVector3d colour = pupil + (iris - pupil) * to_iris;
    colour += (limbus - colour) * to_limbus;
    colours.row(v) = colour + (sclera.colour - colour) * to_white;
  }
}

}  // namespace

FaceLook face_look(const Topology& topology, const Points& neutral) {
  FaceLook look;
  look.colours = skin.colour.replicate(topology.vertex_count(), 1);
  look.finishes.assign(topology.vertex_count(), skin.finish);
  if (topology.has_set("lips")) {
    const std::vector<double> amount = softened(topology.set("lips"), topology);
    for (int v = 0; v < topology.vertex_count(); ++v) {
      look.colours.row(v) += (lips.colour - skin.colour) * amount[v];
      look.finishes[v] = mix(skin.finish, lips.finish, static_cast<float>(amount[v]));
    }
  }
  for (const auto& [name, vertices] : topology.sets()) {
    for (const auto& [prefix, substance] : by_prefix) {
      if (!name.starts_with(prefix)) continue;
      for (const int v : vertices) {
        look.colours.row(v) = substance->colour;
        look.finishes[v] = substance->finish;
      }
    }
    for (const std::string_view prefix : hidden_prefixes)
      if (name.starts_with(prefix))
        look.hidden_vertices.insert(look.hidden_vertices.end(), vertices.begin(), vertices.end());
  }
  for (const char* eye : {"eyeball_left", "eyeball_right"})
    if (topology.has_set(eye)) paint_eye(topology.set(eye), neutral, look.colours);
  return look;
}

}  // namespace vultus::render
