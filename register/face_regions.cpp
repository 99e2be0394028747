#include "register/face_regions.h"

#include <algorithm>
#include <cmath>

#include "core/transform.h"

namespace vultus::registration {
namespace {

using Flags = std::vector<bool>;

template <typename Inside>
Flags flags_where(const Flags& fitted, Inside inside) {
  Flags flags(fitted.size(), false);
  for (std::size_t v = 0; v < fitted.size(); ++v) flags[v] = fitted[v] && inside(static_cast<int>(v));
  return flags;
}

Flags flags_of_set(const Topology& topology, const std::string& set, const Flags& fitted) {
  Flags flags(fitted.size(), false);
  for (int v : topology.set(set)) flags[v] = fitted[v];
  return flags;
}

// Regions measured out on a face that looks along z, by proportions of `eyes`, the outer corners' distance.
class Measured {
 public:
  Measured(const Ibug68& ibug, const Points& face) : ibug_(ibug), face_(face) {
    eyes_ = (point(45) - point(36)).norm();
  }

  static bool possible(const Template& head) {
    return head.ibug68 && std::none_of(head.ibug68->begin() + 17, head.ibug68->end(), [](int v) { return v < 0; }) &&
           (*head.ibug68)[8] >= 0;
  }

  bool forehead(int v) const {
    double brows = point(17).y();
    for (int i = 18; i < 27; ++i) brows = std::max(brows, point(i).y());
    const auto p = face_.row(v);
    return p.y() > brows + 0.03 * eyes_ && p.y() < brows + 0.65 * eyes_ && std::abs(p.x()) < 0.65 * eyes_ &&
           p.z() > point(36).z() - 0.15 * eyes_;
  }
  bool nose(int v) const {
    const auto p = face_.row(v);
    const double t = std::clamp((point(27).y() - p.y()) / (point(27).y() - point(33).y()), 0.0, 1.0);
    const double half = (0.08 + 0.16 * t) * eyes_;
    return p.y() < point(27).y() && p.y() > point(33).y() - 0.05 * eyes_ && std::abs(p.x()) < half &&
           p.z() > point(33).z() - 0.22 * eyes_;
  }
  bool chin(int v) const {
    const auto p = face_.row(v);
    return p.y() < point(57).y() - 0.04 * eyes_ && p.y() > point(8).y() - 0.02 * eyes_ &&
           std::abs(p.x()) < 0.35 * eyes_ && p.z() > point(8).z() - 0.2 * eyes_;
  }
  bool under_chin(int v) const {
    const auto p = face_.row(v);
    return p.y() < point(8).y() - 0.02 * eyes_ && p.y() > point(8).y() - 0.5 * eyes_ && std::abs(p.x()) < 0.4 * eyes_ &&
           p.z() > point(8).z() - 0.75 * eyes_;
  }
  // From the chin to the middle of the forehead, short of temples, ears and the sides of the jaw.
  bool front(int v) const {
    const auto p = face_.row(v);
    return p.y() > point(8).y() - 0.02 * eyes_ && p.y() < 0.5 * (point(19).y() + point(24).y()) + 0.45 * eyes_ &&
           std::abs(p.x()) < 0.65 * eyes_ && p.z() > point(36).z() - 0.3 * eyes_;
  }
  bool around_eyes(int v) const {
    for (int i = 36; i < 48; ++i)
      if ((point(i) - face_.row(v)).norm() < 0.1 * eyes_) return true;
    return false;
  }
  bool lips(int v) const {
    for (int i = 48; i < 68; ++i)
      if ((point(i) - face_.row(v)).norm() < 0.07 * eyes_) return true;
    return false;
  }

 private:
  Eigen::RowVector3d point(int i) const { return face_.row(ibug_[i]); }

  const Ibug68& ibug_;
  const Points& face_;
  double eyes_ = 0.0;
};

}  // namespace

std::map<std::string, Flags> face_regions(const Template& head, const Topology& topology, const Points& positions,
                                          const Flags& fitted) {
  std::map<std::string, Flags> regions;
  regions["all"] = fitted;
  for (const auto& [region, set] : {std::pair("face", "face"), std::pair("lips", "lips"), std::pair("eyes", "lids"),
                                    std::pair("ears", "ears"), std::pair("neck", "neck")})
    if (topology.has_set(set)) regions[region] = flags_of_set(topology, set, fitted);
  if (Measured::possible(head) && positions.rows() >= head.neutral.rows()) {
    const Similarity upright =
        fit_similarity_robust(positions.topRows(head.neutral.rows()), head.neutral, Scaling::free).target_from_source;
    const Points face = transformed(upright, positions);
    const Measured measured(*head.ibug68, face);
    regions["forehead"] = flags_where(fitted, [&](int v) { return measured.forehead(v); });
    regions["nose"] = flags_where(fitted, [&](int v) { return measured.nose(v); });
    regions["chin"] = flags_where(fitted, [&](int v) { return measured.chin(v); });
    regions["under_chin"] = flags_where(fitted, [&](int v) { return measured.under_chin(v); });
    const Flags whole = regions.contains("face") ? regions["face"] : fitted;
    regions["front"] = flags_where(whole, [&](int v) { return measured.front(v); });
    regions["left_half"] = flags_where(whole, [&](int v) { return face(v, 0) > 0.0; });
    regions["right_half"] = flags_where(whole, [&](int v) { return face(v, 0) < 0.0; });
    if (!regions.contains("eyes"))
      regions["eyes"] = flags_where(fitted, [&](int v) { return measured.around_eyes(v); });
    if (!regions.contains("lips")) regions["lips"] = flags_where(fitted, [&](int v) { return measured.lips(v); });
  }
  std::erase_if(regions, [](const auto& region) {
    return std::find(region.second.begin(), region.second.end(), true) == region.second.end();
  });
  return regions;
}

}  // namespace vultus::registration
