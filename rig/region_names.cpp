#include "rig/region_names.h"

#include <algorithm>
#include <limits>
#include <set>

#include "rig/feature_points.h"

namespace vultus::rig {
namespace {

struct Place {
  std::string name;
  std::vector<Eigen::Vector3d> points;
};

constexpr double kBothSides = 0.25;  // of the votes on the lesser side: the region spans the face

class Face {
 public:
  Face(const Points& neutral, const registration::Ibug68& points) : neutral_(neutral), points_(points) {}
  bool has(std::initializer_list<int> indices) const {
    return std::all_of(indices.begin(), indices.end(), [&](int i) { return points_[i] >= 0; });
  }
  Eigen::Vector3d at(int i) const { return neutral_.row(points_[i]).transpose(); }
  std::vector<Eigen::Vector3d> all(std::initializer_list<int> indices) const {
    std::vector<Eigen::Vector3d> found;
    for (int i : indices)
      if (points_[i] >= 0) found.push_back(at(i));
    return found;
  }

 private:
  const Points& neutral_;
  const registration::Ibug68& points_;
};

std::vector<Place> places_of(const Face& face) {
  std::vector<Place> places = {{"brow", face.all({17, 18, 19, 20, 21, 22, 23, 24, 25, 26})},
                               {"eye", face.all({36, 37, 38, 39, 40, 41, 42, 43, 44, 45, 46, 47})},
                               {"nose", face.all({28, 29, 30, 31, 33, 35})},
                               {"mouth", face.all({48, 54, 60, 64})},
                               {"upper_lip", face.all({50, 51, 52, 61, 62, 63})},
                               {"lower_lip", face.all({56, 57, 58, 65, 66, 67})},
                               {"jaw", face.all({4, 5, 6, 7, 8, 9, 10, 11, 12})}};
  // The cheeks have no points of their own: below the outer eye corner at the height between eye and mouth.
  if (face.has({36, 45, 48, 54}))
    places.push_back({"cheek", {0.55 * face.at(36) + 0.45 * face.at(48), 0.55 * face.at(45) + 0.45 * face.at(54)}});
  if (face.has({8, 30, 57})) {
    const Eigen::Vector3d down = face.at(8) - face.at(57), back(0.0, 0.0, -0.6 * (face.at(8) - face.at(30)).norm());
    places.push_back({"neck", {face.at(8) + 1.5 * down + back}});
  }
  std::erase_if(places, [](const Place& place) { return place.points.empty(); });
  return places;
}

int nearest_place(const std::vector<Place>& places, const Eigen::Vector3d& point) {
  int best = 0;
  double best_distance = std::numeric_limits<double>::infinity();
  for (std::size_t p = 0; p < places.size(); ++p)
    for (const Eigen::Vector3d& own : places[p].points)
      if (const double distance = (own - point).squaredNorm(); distance < best_distance) {
        best_distance = distance;
        best = static_cast<int>(p);
      }
  return best;
}

struct Claim {
  double votes;
  int region;
  std::string name;
};

/// Votes of a region's vertices for each place, by the side of the face they lie on.
struct Votes {
  Eigen::MatrixXd left, right;  // regions × places
};

Votes count_votes(const Actor& actor, const Segmentation& segmentation, const std::vector<Place>& places) {
  const auto count = static_cast<Eigen::Index>(places.size());
  Votes votes{Eigen::MatrixXd::Zero(segmentation.regions, count), Eigen::MatrixXd::Zero(segmentation.regions, count)};
  for (int v = 0; v < actor.topology->vertex_count() && count > 0; ++v) {
    if (!segmentation.moving[v]) continue;
    const int place = nearest_place(places, actor.neutral().row(v).transpose());
    Eigen::MatrixXd& side = actor.neutral()(v, 0) > 0.0 ? votes.left : votes.right;
    side(segmentation.labels[v], place) += segmentation.field.range[v];
  }
  return votes;
}

/// Claims of every region to every place as shares of its votes, strongest first.
std::vector<Claim> claims_of(const std::vector<Place>& places, const Votes& votes) {
  std::vector<Claim> claims;
  for (int region = 0; region < static_cast<int>(votes.left.rows()); ++region) {
    const double left = votes.left.row(region).sum(), right = votes.right.row(region).sum(), total = left + right;
    if (!(total > 0.0)) continue;
    const std::string side = std::min(left, right) > kBothSides * total ? "" : left > right ? "_left" : "_right";
    for (Eigen::Index p = 0; p < static_cast<Eigen::Index>(places.size()); ++p)
      claims.push_back({(votes.left(region, p) + votes.right(region, p)) / total, region, places[p].name + side});
  }
  std::erase_if(claims, [](const Claim& claim) { return !(claim.votes > 0.0); });
  std::stable_sort(claims.begin(), claims.end(), [](const Claim& a, const Claim& b) { return a.votes > b.votes; });
  return claims;
}

/// A claim this much weaker than the region's best says nothing about where the region lies.
constexpr double kWeakestShare = 0.25;

std::vector<std::string> settle(const std::vector<Claim>& claims, int regions) {
  std::vector<std::string> names(regions), best(regions);
  std::vector<double> most(regions, 0.0);
  std::set<std::string> taken;
  for (const Claim& claim : claims) {
    if (best[claim.region].empty()) {
      best[claim.region] = claim.name;
      most[claim.region] = claim.votes;
    }
    if (!names[claim.region].empty() || claim.votes < kWeakestShare * most[claim.region]) continue;
    if (taken.insert(claim.name).second) names[claim.region] = claim.name;
  }
  for (int region = 0; region < regions; ++region) {
    const std::string stem = best[region].empty() ? "region" : best[region];
    for (int number = best[region].empty() ? 1 : 2; names[region].empty(); ++number)
      if (const std::string name = stem + "_" + std::to_string(number); taken.insert(name).second) names[region] = name;
  }
  return names;
}

}  // namespace

std::vector<std::string> region_names(const Actor& actor, const Segmentation& segmentation) {
  const registration::Ibug68 points = face_points(*actor.topology, actor.ibug68);
  const std::vector<Place> places = places_of(Face(actor.neutral(), points));
  return settle(claims_of(places, count_votes(actor, segmentation, places)), segmentation.regions);
}

}  // namespace vultus::rig
