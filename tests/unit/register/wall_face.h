#pragma once

#include <cmath>
#include <tuple>

#include "core/mesh.h"
#include "register/template.h"
#include "synthetic_surfaces.h"

namespace vultus::registration::test {

// A face as flat as a wall in the plane z = 0, in millimetres: mouth at the origin, eyes above it.
struct WallFace {
  Template head;
  Points positions{68, 3};
  WallFace() {
    head.ibug68.emplace();
    positions.setConstant(500.0);
    for (int i = 0; i < 68; ++i) (*head.ibug68)[i] = i;
    put(48, -25, 0);
    put(54, 25, 0);
    for (int k = -1; k <= 1; ++k) {
      put(51 + k, 10 * k, 9);
      put(57 - k, 10 * k, -9);
      put(62 + k, 10 * k, 0.2);
      put(66 - k, 10 * k, -0.2);
    }
    put(27, 0, 50);
    put(33, 0, 20);
    for (int side : {-1, 1}) {
      const int first = side < 0 ? 36 : 42;
      put(first, side < 0 ? -45 : 15, 50);
      put(first + 3, side < 0 ? -15 : 45, 50);
      for (const auto& [above, below, x] : {std::tuple(1, 5, -4), std::tuple(2, 4, 4)}) {
        put(first + above, 30 * side + x, 54);
        put(first + below, 30 * side + x, 46);
      }
    }
  }
  void put(int i, double x, double y) { positions.row(i) << x, y, 0; }
};

// A grid of 1 mm by 0.5 mm over the face, `depth(x, y)` behind the wall.
template <typename Depth>
Mesh wall(Depth depth) {
  return grid(121, 201, [&](int c, int r) {
    const double x = c - 60.0, y = 0.5 * r - 30.0;
    return Eigen::Vector3d(x, y, -depth(x, y));
  });
}

// Eyes 2 mm behind lids that stand 9 mm in front of the eyes' corners, open by `gap`.
inline double eye_depth(double x, double y, double gap) {
  const bool in_opening = std::abs(std::abs(x) - 30.0) < 12.0 && std::abs(y - 50.0) < 0.5 * gap;
  return y < 25.0 ? 0.0 : in_opening ? -7.0 : -9.0;
}

}  // namespace vultus::registration::test
