#include "apps/virtual_stage/face_features.h"

#include <algorithm>

#include "register/template_head.h"

namespace vultus::virtual_stage {
namespace {

void add_line(TopologyData& data, const std::string& name, std::vector<int> vertices) {
  std::sort(vertices.begin(), vertices.end());
  data.sets[name] = std::move(vertices);
}

}  // namespace

std::shared_ptr<const Topology> with_contact_lines(const registration::Template& head) {
  TopologyData data = head.topology->data();
  const auto add = [&](const std::string& upper_name, const std::string& lower_name,
                       const registration::VertexPairs& pairs, const std::vector<int>& ends) {
    std::vector<int> upper = ends, lower = ends;
    for (const auto& [u, l] : pairs) {
      upper.push_back(u);
      lower.push_back(l);
    }
    add_line(data, upper_name, upper);
    add_line(data, lower_name, lower);
  };
  const auto landmark = [&](const char* name) { return head.topology->landmarks().at(name); };
  add("lip_line_upper", "lip_line_lower", registration::lip_seal(), {});
  add("lid_line_upper_left", "lid_line_lower_left", registration::lid_seal_left(), {landmark("3.11"), landmark("3.7")});
  add("lid_line_upper_right", "lid_line_lower_right", registration::lid_seal_right(),
      {landmark("3.8"), landmark("3.12")});
  return Topology::make(std::move(data));
}

FaceFeatures::FaceFeatures(const Topology& topology_in, const Points& positions_in)
    : topology(topology_in),
      positions(positions_in),
      mirror(registration::template_mirror()),
      normals(vertex_normals(topology_in, positions_in)),
      fields(topology_in, positions_in) {
  scale = (at("3.7") - at("3.7", Side::right)).norm() / 90.0;
}

Eigen::Vector3d FaceFeatures::at(const std::string& left_name, Side side) const {
  const int vertex = topology.landmarks().at(left_name);
  return positions.row(side == Side::left ? vertex : mirror[vertex]);
}

std::vector<bool> FaceFeatures::members(const std::string& set) const {
  std::vector<bool> in(topology.vertex_count(), false);
  for (const int v : topology.set(set)) in[v] = true;
  return in;
}

std::vector<int> FaceFeatures::line(const std::string& set) const {
  std::vector<int> vertices = topology.set(set);
  std::sort(vertices.begin(), vertices.end(), [&](int a, int b) { return positions(a, 0) < positions(b, 0); });
  return vertices;
}

void soften(Eigen::VectorXd& values, const Topology& topology, int rounds) {
  const Triangles& triangles = topology.triangles();
  for (int round = 0; round < rounds; ++round) {
    Eigen::VectorXd sum = values, count = Eigen::VectorXd::Ones(values.size());
    for (Eigen::Index t = 0; t < triangles.rows(); ++t)
      for (int c = 0; c < 3; ++c) {
        sum[triangles(t, c)] += values[triangles(t, (c + 1) % 3)];
        count[triangles(t, c)] += 1.0;
      }
    values = sum.cwiseQuotient(count);
  }
}

double smooth_step(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

double interpolate(const std::vector<std::pair<double, double>>& points, double x) {
  if (x <= points.front().first) return points.front().second;
  for (std::size_t i = 1; i < points.size(); ++i)
    if (x <= points[i].first) {
      const auto& [x0, y0] = points[i - 1];
      const auto& [x1, y1] = points[i];
      return y0 + (y1 - y0) * (x - x0) / std::max(x1 - x0, 1e-9);
    }
  return points.back().second;
}

}  // namespace vultus::virtual_stage
