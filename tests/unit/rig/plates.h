#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "rig/actor.h"

namespace vultus::rig {

/// A place on a sheet, in columns and rows, and how it moves.
struct Plate {
  double column, row;
  Eigen::RowVector3d motion;  // mm
};

/// A square sheet of 1 mm quads, `columns` × `rows` vertices about the origin in x and y, with UVs in [0.05, 0.95]².
/// Each plate is a disc of radius 5 mm that moves as a whole, fading out over 3 mm; each has two poses of its own, one
/// the other way.
inline Actor moving_plates(int columns, int rows, const std::vector<Plate>& plates) {
  TopologyData data;
  data.vertex_count = columns * rows;
  data.face_offsets.push_back(0);
  data.uvs.resize(data.vertex_count, 2);
  Points rest(data.vertex_count, 3);
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      rest.row(r * columns + c) << c - 0.5 * (columns - 1), r - 0.5 * (rows - 1), 0.0;
      data.uvs.row(r * columns + c) << 0.05 + 0.9 * c / (columns - 1), 0.05 + 0.9 * r / (rows - 1);
      if (r + 1 == rows || c + 1 == columns) continue;
      const int v = r * columns + c;
      for (int corner : {v, v + 1, v + columns + 1, v + columns}) data.corner_vertex.push_back(corner);
      data.face_offsets.push_back(static_cast<int>(data.corner_vertex.size()));
    }
  data.corner_uv = data.corner_vertex;
  Actor actor;
  actor.name = "plates";
  actor.topology = Topology::make(std::move(data));
  actor.rest = rest;
  actor.poses.push_back({"neutral", {}, rest});
  for (const Plate& plate : plates)
    for (double sign : {1.0, -0.6}) {
      Points moved = rest;
      for (int v = 0; v < columns * rows; ++v) {
        const double distance = std::hypot(v % columns - plate.column, v / columns - plate.row);
        moved.row(v) += sign * std::clamp((8.0 - distance) / 3.0, 0.0, 1.0) * plate.motion;
      }
      actor.poses.push_back({"pose" + std::to_string(actor.poses.size()), {}, moved});
    }
  if (plates.empty()) actor.poses.push_back({"still", {}, rest});
  return actor;
}

/// Plate of each vertex that lies on the part of a disc that moves as a whole; -1 elsewhere.
inline std::vector<int> plate_truth(const Actor& actor, const std::vector<Plate>& plates) {
  std::vector<int> truth(actor.topology->vertex_count(), -1);
  const Eigen::RowVector3d corner = actor.neutral().row(0);
  for (int v = 0; v < actor.topology->vertex_count(); ++v)
    for (std::size_t p = 0; p < plates.size(); ++p)
      if (std::hypot(actor.neutral()(v, 0) - corner.x() - plates[p].column,
                     actor.neutral()(v, 1) - corner.y() - plates[p].row) <= 5.0)
        truth[v] = static_cast<int>(p);
  return truth;
}

/// The vertex at (−x, y) of each vertex of a sheet.
inline std::vector<int> mirrored_vertices(const Actor& actor) {
  std::vector<int> mirror(actor.topology->vertex_count());
  for (int v = 0; v < actor.topology->vertex_count(); ++v)
    for (int other = 0; other < actor.topology->vertex_count(); ++other)
      if (std::abs(actor.neutral()(v, 0) + actor.neutral()(other, 0)) < 1e-9 &&
          std::abs(actor.neutral()(v, 1) - actor.neutral()(other, 1)) < 1e-9)
        mirror[v] = other;
  return mirror;
}

/// The same sheet with two loose quads of four vertices over its first corner, 3 mm above it: the first moves by
/// `motion` in the poses of the first plate as that plate does, the second never.
inline Actor with_loose_parts(Actor actor, const Eigen::RowVector3d& motion) {
  TopologyData data = actor.topology->data();
  const int first = data.vertex_count;
  const Eigen::Index uv_rows = data.uvs.rows();
  data.vertex_count += 8;
  data.uvs.conservativeResize(uv_rows + 8, 2);
  for (int part = 0; part < 2; ++part) {
    for (int k = 0; k < 4; ++k) {
      data.corner_vertex.push_back(first + 4 * part + k);
      data.corner_uv.push_back(static_cast<int>(uv_rows) + 4 * part + k);
      data.uvs.row(uv_rows + 4 * part + k) << 0.01 + 0.02 * (k == 1 || k == 2) + 0.5 * part, 0.01 + 0.02 * (k >= 2);
    }
    data.face_offsets.push_back(static_cast<int>(data.corner_vertex.size()));
  }
  actor.topology = Topology::make(std::move(data));
  const Eigen::RowVector3d corner = actor.neutral().row(0);
  const auto extend = [&](Points& positions, double amount) {
    positions.conservativeResize(first + 8, 3);
    for (int k = 0; k < 8; ++k) {
      const int q = k % 4;
      positions.row(first + k) = corner + Eigen::RowVector3d(q == 1 || q == 2, q >= 2, 3.0);
      if (k < 4) positions.row(first + k) += amount * motion;
    }
  };
  for (std::size_t p = 0; p < actor.poses.size(); ++p)
    extend(actor.poses[p].positions, p == 1 ? 1.0 : p == 2 ? -0.6 : 0.0);
  extend(actor.rest, 0.0);
  return actor;
}

/// The same sheet with its faces at x < 0 in one chart and the others in another that is upside down beside it.
inline Actor two_charts(Actor actor) {
  TopologyData data = actor.topology->data();
  const Eigen::Index rows = data.uvs.rows();
  Uvs both(2 * rows, 2);
  for (Eigen::Index v = 0; v < rows; ++v) {
    const double u = data.uvs(v, 0), w = data.uvs(v, 1);
    both.row(v) << 0.9 * u, w;
    both.row(rows + v) << 0.1 + 0.9 * u, 1.0 - w;
  }
  data.uvs = both;
  for (std::size_t f = 0; f + 1 < data.face_offsets.size(); ++f) {
    double middle = 0.0;
    for (int c = data.face_offsets[f]; c < data.face_offsets[f + 1]; ++c)
      middle += actor.neutral()(data.corner_vertex[c], 0);
    if (middle > 0.0)
      for (int c = data.face_offsets[f]; c < data.face_offsets[f + 1]; ++c) data.corner_uv[c] += static_cast<int>(rows);
  }
  actor.topology = Topology::make(std::move(data));
  return actor;
}

}  // namespace vultus::rig
