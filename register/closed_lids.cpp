#include "register/closed_lids.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "register/face_axes.h"
#include "register/seals.h"

namespace vultus::registration {
namespace {

constexpr double meeting = 0.15;    // share of the opening, from the lower rim
constexpr double following = 0.75;  // openings from a rim to where the skin stays: about to the crease

// An open eye seen from its middle: places by how far across they are and how high.
class Eye {
 public:
  Eye(const Ibug68& ibug, bool right, const std::vector<std::pair<int, int>>& rims, const Points& rest) : rest_(rest) {
    auto point = [&](int i) -> Eigen::Vector3d { return rest.row(ibug[i]).transpose(); };
    const int inner = right ? 39 : 42, outer = right ? 36 : 45;
    const int left_end = right ? inner : outer, right_end = right ? outer : inner;  // the subject's sides
    const double width = (point(inner) - point(outer)).norm();
    axes_ = face_axes(point(left_end) - point(right_end), point(27) - point(33));
    centre_ = 0.5 * (point(inner) + point(outer)) - 0.4 * width * axes_.front;
    reach_ = width;
    for (const int corner : {left_end, right_end}) add(ibug[corner], ibug[corner]);
    for (const auto& [upper, lower] : rims) add(upper, lower);
    std::sort(rims_.begin(), rims_.end(), [](const Rims& a, const Rims& b) { return a.x < b.x; });
  }

  // Where closing takes a vertex, if it has a part in that.
  struct Way {
    Eigen::Vector3d end;
    bool rim;  // or behind it
  };
  std::optional<Way> closed(int v) const {
    const Eigen::Vector3d arm = rest_.row(v).transpose() - centre_;
    if (arm.norm() > reach_) return {};
    const auto right = std::upper_bound(rims_.begin(), rims_.end(), arm.dot(axes_.across),
                                        [](double x, const Rims& rims) { return x < rims.x; });
    if (right == rims_.begin() || right == rims_.end()) return {};
    const Rims &a = *(right - 1), &b = *right;
    const double t = (arm.dot(axes_.across) - a.x) / std::max(1e-9, b.x - a.x);
    const double upper = (1 - t) * a.upper + t * b.upper, lower = (1 - t) * a.lower + t * b.lower;
    const double opening = upper - lower, height = elevation(arm);
    if (opening <= 0.0) return {};
    const bool above = height > 0.5 * (upper + lower);
    const double beyond = std::max(0.0, above ? height - upper : lower - height) / (following * opening);
    if (beyond >= 1.0) return {};
    const double turn = (1.0 - beyond * beyond) * opening * (above ? -(1.0 - meeting) : meeting);
    return Way{centre_ + Eigen::AngleAxisd(-turn, axes_.across) * arm, beyond == 0.0};
  }

  // `place` no farther from the eye's middle than the scan's skin.
  Eigen::Vector3d within(const ScanSurface& scan, const Eigen::Vector3d& place) const {
    const Eigen::Vector3d arm = place - centre_;
    const double far = 2.0 * arm.norm();  // from outside: what lies behind a closed lid is noise
    const auto skin = scan.rays().hit(centre_ + far * arm.normalized(), -arm.normalized(), 0.0, far);
    return centre_ + (skin ? std::min(arm.norm(), far - skin->distance) : arm.norm()) * arm.normalized();
  }

 private:
  struct Rims {
    double x, upper, lower;  // mm; radians
  };
  double elevation(const Eigen::Vector3d& arm) const { return std::atan2(arm.dot(axes_.up), arm.dot(axes_.front)); }
  void add(int upper, int lower) {
    const Eigen::Vector3d a = rest_.row(upper).transpose() - centre_, b = rest_.row(lower).transpose() - centre_;
    rims_.push_back({0.5 * (a + b).dot(axes_.across), elevation(a), elevation(b)});
  }

  const Points& rest_;
  FaceAxes axes_;
  Eigen::Vector3d centre_;
  double reach_ = 0.0;
  std::vector<Rims> rims_;
};

}  // namespace

LidClosing find_lid_closing(const Template& head, const std::vector<bool>& fitted, const Points& rest,
                            const ScanSurface& scan) {
  LidClosing closing;
  constexpr double closed = 2.2, open = 4.4;  // mm: a groove at most; a narrow eye fits without help
  for (const Seal& seal : find_seals(head, rest, scan)) {
    const bool right = seal.name == "right lids";
    if (!right && seal.name != "left lids") continue;
    if (seal.scan_gap < 0.0 || seal.scan_gap > closed || seal.mesh_gap < open) continue;
    closing.lids.push_back(seal.name);
    const Eye eye(*head.ibug68, right, seal.pairs, rest);
    for (int v = 0; v < rest.rows(); ++v) {
      if (!fitted[v]) continue;
      const auto way = eye.closed(v);
      if (!way || (way->end - rest.row(v).transpose()).norm() < 0.5) continue;
      // Rims vanish from the scan as they meet; the skin beyond shows and only begins like this.
      closing.terms.push_back({v, eye.within(scan, way->end), way->rim ? 0.1 : 0.02});
    }
  }
  return closing;
}

}  // namespace vultus::registration
