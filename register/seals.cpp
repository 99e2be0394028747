#include "register/seals.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "core/statistics.h"
#include "register/face_axes.h"

namespace vultus::registration {
namespace {

constexpr double nothing = -std::numeric_limits<double>::infinity();

class Face {
 public:
  Face(const Ibug68& ibug, const Points& positions) : ibug_(ibug), positions_(positions) {}
  bool has(std::initializer_list<int> points) const {
    return std::all_of(points.begin(), points.end(), [&](int i) { return ibug_[i] >= 0; });
  }
  Eigen::Vector3d operator()(int i) const { return positions_.row(ibug_[i]).transpose(); }
  double mean_gap(std::initializer_list<std::pair<int, int>> pairs) const {
    double sum = 0.0;
    for (const auto& [a, b] : pairs) sum += ((*this)(a) - (*this)(b)).norm();
    return sum / static_cast<double>(pairs.size());
  }

 private:
  const Ibug68& ibug_;
  const Points& positions_;
};

// What rays meet one after another: height along each ray's way back, and how finely the scan is meshed there.
struct Profile {
  std::vector<double> height;  // mm; `nothing` without data
  double edge = 0.0;           // median edge of the triangles met, mm; 0 when none was
  double missing() const {
    return static_cast<double>(std::count(height.begin(), height.end(), nothing)) / static_cast<double>(height.size());
  }
};

class Prober {
 public:
  explicit Prober(const ScanSurface& scan) : scan_(scan) {}

  // Along −direction from `reach` above `origin` to as far below: the height above `origin`.
  void probe(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double reach) {
    const auto hit = scan_.rays().hit(origin + reach * direction, -direction, 0.0, 2.0 * reach);
    const bool is_data = hit && scan_.is_data(hit->place);
    heights_.push_back(is_data ? reach - hit->distance : nothing);
    if (is_data) edges_.push_back(edge_of(hit->place.triangle));
  }
  Profile profile() const { return {heights_, edges_.empty() ? 0.0 : median(edges_)}; }

 private:
  double edge_of(int triangle) const {
    const Mesh& mesh = scan_.mesh();
    const auto c = mesh.topology->triangles().row(triangle);
    double longest = 0.0;
    for (int k = 0; k < 3; ++k)
      longest = std::max(longest, (mesh.positions.row(c[k]) - mesh.positions.row(c[(k + 1) % 3])).norm());
    return longest;
  }

  const ScanSurface& scan_;
  std::vector<double> heights_, edges_;
};

// Width of what lies more than `depth` below the highest places on both sides.
double recess_width(const std::vector<double>& height, double step, double depth) {
  std::vector<double> from_end(height.size());
  double highest = nothing;
  for (std::size_t i = height.size(); i-- > 0;) from_end[i] = highest = std::max(highest, height[i]);
  highest = nothing;
  double width = 0.0;
  for (std::size_t i = 0; i < height.size(); ++i) {
    highest = std::max(highest, height[i]);
    if (height[i] < std::min(highest, from_end[i]) - depth) width += step;
  }
  return width;
}

constexpr double probe_step = 0.35;  // mm: a scan's fine spacing

// Mean opening over three lines across the mouth; -1 where the scan cannot tell.
double lip_gap_of(const Face& face, const ScanSurface& scan) {
  const Eigen::Vector3d across = (face(54) - face(48)).normalized();
  std::vector<double> gaps;
  for (const auto& [top, bottom] : {std::pair(50, 58), std::pair(51, 57), std::pair(52, 56)}) {
    const Eigen::Vector3d down = face(bottom) - face(top);
    const Eigen::Vector3d front = down.cross(across).normalized();
    const int steps = static_cast<int>(1.3 * down.norm() / probe_step);
    Prober prober(scan);
    for (int i = 0; i <= steps; ++i)
      prober.probe(face(top) + (-0.15 + 1.3 * i / std::max(1, steps)) * down, front, 35.0);
    const Profile profile = prober.profile();
    if (profile.edge == 0.0 || profile.edge > 3.0) return -1.0;
    gaps.push_back(recess_width(profile.height, probe_step, 3.0));
  }
  return median(gaps);
}

struct Eye {
  int inner, outer;  // corners
};

// How much a profile rises within `window` samples from `at` beyond the slope on both sides, where all of it is data.
// Next to a steep rise level skin would seem to drop: what does not go down itself is no step down, and likewise up.
std::optional<double> step_at(const std::vector<double>& height, int at, int window) {
  if (at < window || at + 2 * window >= static_cast<int>(height.size())) return {};
  const double before = height[at] - height[at - window], after = height[at + 2 * window] - height[at + window];
  constexpr double level = 0.3;  // mm
  const double change = height[at + window] - height[at], step = change - 0.5 * (before + after);
  if (!std::isfinite(step)) return {};
  return std::abs(change) < level || change * step < 0.0 ? 0.0 : step;
}

// Distance between the step down into the eye and the step up out of it, 0 without such steps, nothing where neither is
// clear. The upper lid of an open eye is the higher step; where lids meet, a fold may rise and no skin goes down, or
// both steps are walls of one groove.
std::optional<double> aperture(const std::vector<double>& height) {
  constexpr double clear = 0.9, none = 0.6;                            // mm; a lid is 1.5 to 2 mm thick
  constexpr double level = 0.3, fold = 1.2, wall = 1.4, groove = 2.2;  // mm
  const int window = static_cast<int>(std::lround(1.4 / probe_step));
  double drop = 0.0, rise = 0.0;
  int drop_at = -1, rise_at = -1;
  for (int i = 0; i < static_cast<int>(height.size()); ++i) {
    const std::optional<double> step = step_at(height, i, window);
    if (step && -*step > drop) drop = -*step, drop_at = i;
    if (step && *step > rise) rise = *step, rise_at = i;
  }
  if (drop >= clear && rise >= clear && rise_at > drop_at) return (rise_at - drop_at) * probe_step;
  if (drop <= none && rise <= none) return 0.0;
  if (drop <= level && rise <= fold) return 0.0;
  const double apart = (rise_at - drop_at) * probe_step;
  if (apart > 0.0 && apart <= groove && rise <= wall) return apart;
  return {};
}

double lid_gap_of(const Face& face, const Eye& eye, const ScanSurface& scan) {
  const Eigen::Vector3d middle = 0.5 * (face(eye.inner) + face(eye.outer));
  const double width = (face(eye.inner) - face(eye.outer)).norm();
  const auto [across, up, front] = face_axes(face(45) - face(36), face(27) - face(33));
  const Eigen::Vector3d centre = middle - 0.4 * width * front;
  const double radius = 0.75 * width, step = probe_step / radius;  // about as far as lids lie from the centre
  std::vector<double> gaps;
  for (const double turn : {-0.2, 0.0, 0.2}) {
    Prober prober(scan);
    const Eigen::Vector3d out = Eigen::AngleAxisd(turn, up) * front;
    for (double rise = -0.62; rise <= 0.45; rise += step)  // from the cheek to below the brow
      prober.probe(centre, std::cos(rise) * out + std::sin(rise) * up, 2.0 * radius);
    const Profile profile = prober.profile();
    // Steps of a lid drown in coarser triangles, and holes have steps of their own.
    if (profile.edge == 0.0 || profile.edge > 2.5 || profile.missing() > 0.2) continue;
    if (const auto gap = aperture(profile.height)) gaps.push_back(*gap);
  }
  return gaps.size() >= 2 ? median(gaps) : -1.0;
}

// The template's own pairs by that name, else those of the 68-point scheme.
std::vector<std::pair<int, int>> touching(const Template& head, const std::string& name,
                                          std::initializer_list<std::pair<int, int>> scheme) {
  for (const TouchingRims& rims : head.rims)
    if (rims.name == name) return rims.pairs;
  std::vector<std::pair<int, int>> pairs;
  for (const auto& [a, b] : scheme) pairs.emplace_back((*head.ibug68)[a], (*head.ibug68)[b]);
  return pairs;
}

}  // namespace

std::vector<Seal> find_seals(const Template& head, const Points& positions, const ScanSurface& scan) {
  std::vector<Seal> seals;
  if (!head.ibug68) return seals;
  const Face face(*head.ibug68, positions);
  auto add = [&](const std::string& name, std::initializer_list<std::pair<int, int>> pairs, double scan_gap) {
    seals.push_back({name, face.mean_gap(pairs), scan_gap, touching(head, name, pairs)});
  };
  if (face.has({48, 50, 51, 52, 54, 56, 57, 58, 61, 62, 63, 65, 66, 67}))
    add("lips", {{61, 67}, {62, 66}, {63, 65}}, lip_gap_of(face, scan));
  if (face.has({27, 33, 36, 37, 38, 39, 40, 41, 45}))
    add("right lids", {{37, 41}, {38, 40}}, lid_gap_of(face, {39, 36}, scan));
  if (face.has({27, 33, 36, 42, 43, 44, 45, 46, 47}))
    add("left lids", {{43, 47}, {44, 46}}, lid_gap_of(face, {42, 45}, scan));
  return seals;
}

}  // namespace vultus::registration
