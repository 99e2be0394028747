#include "register/jaw.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "register/align.h"
#include "register/gaping_jaw.h"

namespace vultus::registration {
namespace {

constexpr double least_gain = 0.3;  // mm that a motion has to bring the chin nearer to the scan on average

struct Hinge {
  Eigen::Vector3d point, axis;  // axis from the subject's right to left
  Similarity turn(double angle) const {
    Similarity motion;
    motion.rotation = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
    motion.translation = point - motion.rotation * point;
    return motion;
  }
};

struct LipPull {
  Eigen::Vector3d from, to;
  double weight;
};

std::vector<int> chin_vertices(const Points& rest, const std::vector<bool>& fitted, const Eigen::Vector3d& chin,
                               double radius) {
  std::vector<int> vertices;
  for (int v = 0; v < rest.rows(); ++v)
    if (fitted[v] && (rest.row(v).transpose() - chin).norm() < radius) vertices.push_back(v);
  return vertices;
}

// About `count` of all, evenly.
template <typename Item>
std::vector<Item> some_of(const std::vector<Item>& all, std::size_t count) {
  const std::size_t stride = all.size() / count;
  std::vector<Item> some;
  for (std::size_t i = 0; i < all.size(); i += std::max<std::size_t>(1, stride)) some.push_back(all[i]);
  return some;
}

std::vector<LipPull> lower_lip(const Points& rest, const Anchors& anchors) {
  std::vector<LipPull> lip;
  for (int i = 0; i < anchors.size(); ++i)
    for (int outer : {56, 57, 58})
      if (anchors.names[i] == ibug_name(outer))
        lip.push_back(
            {rest.row(anchors.vertices[i]).transpose(), anchors.targets.row(i).transpose(), anchors.confidence[i]});
  return lip;
}

// What the lower lip still lacks after a motion; nothing without landmarks on it.
std::optional<Eigen::Vector3d> lip_shift(const std::vector<LipPull>& lip, const Similarity& motion) {
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  double total = 0.0;
  for (const LipPull& pull : lip) {
    shift += pull.weight * (pull.to - motion * pull.from);
    total += pull.weight;
  }
  if (total <= 0.0) return {};
  return Eigen::Vector3d(shift / total);
}

class ChinOnScan {
 public:
  ChinOnScan(const Topology& topology, const Points& rest, std::vector<int> chin, std::vector<LipPull> lip,
             const ScanSurface& scan)
      : topology_(topology),
        rest_(rest),
        normals_(vertex_normals(topology, rest)),
        chin_(std::move(chin)),
        lip_(std::move(lip)),
        scan_(scan) {}

  // Mean distance of the moved chin from the scan plus that of the moved lower lip from its landmarks, mm. The lip may
  // well move on its own, hence counts less and never more than a few millimetres.
  double mismatch(const Similarity& motion) const {
    const double limit = 6.0;  // what finds no scan counts with it
    double distance = 0.0;
    for (int v : chin_) {
      const Eigen::Vector3d normal = motion.rotation * Eigen::Vector3d(normals_.row(v));
      const auto place = scan_.nearest(motion * Eigen::Vector3d(rest_.row(v)), normal, limit, 0.7);
      distance += place ? place->distance : limit;
    }
    double pull = 0.0, total = 0.0;
    for (const LipPull& point : lip_) {
      pull += point.weight * std::min(20.0, (motion * point.from - point.to).norm());
      total += point.weight;
    }
    return distance / static_cast<double>(chin_.size()) + (total > 0.0 ? 0.3 * pull / total : 0.0);
  }

  std::optional<Similarity> refined(const Similarity& start) const {
    RigidRefinement refinement;
    refinement.first_limit = 8.0;
    refinement.last_limit = 3.0;
    const Alignment found = align_surface(topology_, rest_, chin_, scan_, start, Scaling::fixed, refinement);
    if (found.rms < 0.0) return {};
    return found.scan_from_template;
  }

  const std::vector<LipPull>& lip() const { return lip_; }

 private:
  const Topology& topology_;
  const Points& rest_;
  Points normals_;
  std::vector<int> chin_;
  std::vector<LipPull> lip_;
  const ScanSurface& scan_;
};

std::optional<Similarity> best_motion(const ChinOnScan& chin, const Hinge& hinge) {
  // A closed jaw is the usual case: a motion has to earn its place.
  double least = chin.mismatch(Similarity()) - least_gain;
  std::optional<Similarity> best;
  auto consider = [&](const Similarity& start) {
    const auto motion = chin.refined(start);
    if (!motion) return;
    const double cost = chin.mismatch(*motion);
    if (cost >= least) return;
    least = cost;
    best = motion;
  };
  for (int degrees = 0; degrees <= 30; degrees += 6) {
    Similarity motion = hinge.turn(degrees * M_PI / 180.0);
    if (degrees > 0) consider(motion);
    if (const auto shift = lip_shift(chin.lip(), motion)) {
      motion.translation += *shift;
      consider(motion);
    }
  }
  return best;
}

// Neck that lies on the scan as it is, or where there is none: a chin that comes down must not push it along.
std::vector<PointTerm> still_neck(const Ibug68& ibug, const Topology& topology, const Points& rest,
                                  const std::vector<bool>& fitted, const ScanSurface& scan) {
  const Eigen::Vector3d chin = rest.row(ibug[8]);
  const Eigen::Vector3d up = (rest.row(ibug[27]) - rest.row(ibug[8])).normalized();
  const Points normals = vertex_normals(topology, rest);
  std::vector<PointTerm> terms;
  for (int v = 0; v < rest.rows(); ++v) {
    const Eigen::Vector3d place = rest.row(v);
    if (!fitted[v] || up.dot(place - chin) > -5.0) continue;
    if ((place - chin).norm() < 45.0 || (place - chin).norm() > 90.0) continue;
    if (const auto near = scan.nearest(place, normals.row(v), 5.0, 0.7))
      terms.push_back({v, near->position, 0.3});
    else if (const auto any = scan.rays().closest(place, 12.0); !any || scan.on_border(any->place))
      terms.push_back({v, place, 0.3});
  }
  return some_of(terms, 60);
}

// A hole in the data over closed lips looks like a gape too, but no chin fits below it better than the one at rest.
std::optional<JawOpening> gaping(const Template& head, const Topology& topology, const Points& rest,
                                 const std::vector<bool>& fitted, const ScanSurface& scan) {
  JawOpening opening;
  opening.gape = find_gape(head, rest, scan.rays());
  if (!opening.gape) return {};
  const GapingJaw jaw = find_gaping_jaw(head, topology, rest, fitted, *opening.gape, scan);
  if (jaw.front.empty() || jaw.mismatch > jaw.unmoved - least_gain) return {};
  opening.motion = jaw.motion;
  opening.angle = Eigen::AngleAxisd(jaw.motion.rotation).angle();
  const Eigen::Vector3d chin = rest.row((*head.ibug68)[8]);
  opening.drop = (jaw.motion * chin - chin).norm();
  if (opening.drop < 3.0) return {};
  for (int v : some_of(jaw.front, 40)) opening.terms.push_back({v, jaw.motion * Eigen::Vector3d(rest.row(v)), 0.2});
  // Colour, where there is some, tells better how far skin under the chin goes along.
  if (!scan.mesh().has_colours() && scan.mesh().texture.empty())
    for (const PointTerm& term : still_neck(*head.ibug68, topology, rest, fitted, scan)) opening.terms.push_back(term);
  return opening;
}

struct Rim {
  int ibug;
  Eigen::Vector3d place;
};

// What a gape says of the lips.
struct LipMotion {
  Eigen::Vector3d lift = Eigen::Vector3d::Zero();  // of the upper one
  Eigen::Vector3d roll = Eigen::Vector3d::Zero();  // of the lower one against the jaw
  Similarity jaw;
};

// Whether a point that pictures gave lies where skull and jaw would have it.
bool agrees(int ibug, const Eigen::Vector3d& from, const Eigen::Vector3d& to, const LipMotion& lips) {
  if (is_contour(ibug) || ibug >= 60) return false;  // an outline; and rims, which shape shows better
  if (ibug < 48) return true;
  if (ibug >= 55) return (lips.jaw * from + lips.roll - to).norm() < 5.0;
  if (ibug == 48 || ibug == 54) return (0.5 * (lips.jaw * from + from) - to).norm() < 10.0;
  return (from + lips.lift - to).norm() < 8.0;
}

void add(const Rim& rim, const Ibug68& ibug, Anchors& anchors) {
  const int vertex = ibug[rim.ibug];
  if (vertex < 0 || std::find(anchors.vertices.begin(), anchors.vertices.end(), vertex) != anchors.vertices.end())
    return;
  anchors.add(ibug_name(rim.ibug), vertex, rim.place, 0.8);
}

}  // namespace

JawOpening find_jaw_opening(const Template& head, const Topology& topology, const Points& rest,
                            const std::vector<bool>& fitted, const Anchors& anchors, const ScanSurface& scan) {
  if (!head.ibug68) return {};
  const Ibug68& ibug = *head.ibug68;
  for (int needed : {0, 1, 8, 15, 16})
    if (ibug[needed] < 0) return {};
  if (const auto open = gaping(head, topology, rest, fitted, scan)) return *open;
  auto point = [&](int i) -> Eigen::Vector3d { return rest.row(ibug[i]).transpose(); };
  const Eigen::Vector3d right = 0.5 * (point(0) + point(1)), left = 0.5 * (point(15) + point(16));
  const std::vector<int> around = chin_vertices(rest, fitted, point(8), 28.0);
  if (around.size() < 20) return {};

  const ChinOnScan chin(topology, rest, some_of(around, 250), lower_lip(rest, anchors), scan);
  const auto motion = best_motion(chin, {0.5 * (right + left), (left - right).normalized()});
  JawOpening opening;
  if (motion) opening.drop = (*motion * point(8) - point(8)).norm();
  if (opening.drop < 3.0) return {};
  opening.angle = Eigen::AngleAxisd(motion->rotation).angle();
  opening.motion = *motion;
  const std::vector<int> core = chin_vertices(rest, fitted, point(8), 20.0);
  for (int v : some_of(core, 25)) opening.terms.push_back({v, *motion * Eigen::Vector3d(rest.row(v)), 0.3});
  return opening;
}

Anchors agreeing_anchors(const Template& head, const Anchors& anchors, const Points& rest, const JawOpening& jaw) {
  if (!jaw.gape || !head.ibug68) return anchors;
  const Ibug68& ibug = *head.ibug68;
  std::array<Rim, 6> rims;
  LipMotion lips;
  lips.jaw = jaw.motion;
  for (int i = 0; i < 3; ++i) {
    rims[i] = {61 + i, jaw.gape->upper[i]};
    rims[3 + i] = {67 - i, jaw.gape->lower[i]};
    const Eigen::Vector3d upper = rest.row(ibug[61 + i]), lower = rest.row(ibug[67 - i]);
    lips.lift += (jaw.gape->upper[i] - upper) / 3.0;
    lips.roll += (jaw.gape->lower[i] - jaw.motion * lower) / 3.0;
  }
  std::vector<int> rows;
  for (int i = 0; i < anchors.size(); ++i) {
    const auto point = ibug_index(anchors.names[i]);
    if (!point || anchors.confidence[i] >= 1.0 ||
        agrees(*point, rest.row(anchors.vertices[i]).transpose(), anchors.targets.row(i).transpose(), lips))
      rows.push_back(i);
  }
  Anchors kept = anchors.at(rows);
  for (const Rim& rim : rims) add(rim, ibug, kept);
  return kept;
}

}  // namespace vultus::registration
