#include "apps/virtual_stage/marker_layout.h"

#include <Eigen/Geometry>
#include <optional>

#include "core/error.h"
#include "core/random.h"
#include "core/rays.h"

namespace vultus::virtual_stage {
namespace {

struct Spot {
  const char* label;     ///< without its side
  const char* landmark;  ///< of the left side or the midline
  double x, y;           ///< further, outward and up, in mm of a face whose outer eye corners are 90 mm apart
  bool anchor = false;
};

constexpr Spot on_midline[] = {
    {"CFH1", "forehead_low", 0, 0}, {"CFH2", "forehead", 0, 0},      {"CFH3", "forehead_high", 0, 0},
    {"CGLA", "glabella", 0, 0},     {"CSEL", "sellion", 0, 0, true}, {"CNB1", "nose_bridge", 0, -5},
    {"CNTP", "9.3", 0, 0, true},    {"CPHI", "philtrum", 0, 0},      {"CULP", "8.1", 0, 0, true},
    {"CLLP", "8.2", 0, 0, true},    {"CLAB", "labiomental", 0, 0},   {"CCH1", "2.10", 0, -2},
    {"CCH2", "2.1", 0, 3}};

constexpr Spot on_side[] = {{"FH11", "forehead_low", 14, 2},
                            {"FH12", "forehead_low", 29, 4},
                            {"FH13", "forehead_low", 44, 2},
                            {"FH21", "forehead", 14, 1},
                            {"FH22", "forehead", 29, 1},
                            {"FH23", "forehead", 43, 0},
                            {"FH31", "forehead_high", 18, 0},
                            {"BRO1", "4.1", 0, 0, true},
                            {"BRO2", "brow_inner_left", 1, 0},
                            {"BRO3", "brow_middle_left", 0, 0},
                            {"BRO4", "4.3", 0, 0},
                            {"BRO5", "4.5", 0, 0, true},
                            {"TMP1", "temple_left", 0, 0},
                            {"TMP2", "orbit_outer_left", 4, 2},
                            {"ZYG1", "zygomatic_arch_left", 0, 0},
                            {"EYE1", "orbit_lower_left", -12, -1},
                            {"EYE2", "orbit_lower_left", 0, -3},
                            {"EYE3", "orbit_lower_left", 13, -1},
                            {"NOS1", "9.13", 0, 9},
                            {"NOS2", "9.13", 0, -2},
                            {"NOS3", "9.1", 0, 0, true},
                            {"CHK1", "nose_crease_left", 12, 4},
                            {"CHK2", "5.3", -12, -8},
                            {"CHK3", "5.3", 2, -6},
                            {"CHK4", "5.1", -10, 4},
                            {"CHK5", "5.1", 1, -2},
                            {"CHK6", "5.1", 14, -4},
                            {"NLF1", "nasolabial_high_left", 2, 0},
                            {"NLF2", "nasolabial_left", 0, 0},
                            {"NLF3", "nasolabial_low_left", 1, 0},
                            {"CHK7", "cheek_low_left", 0, 0},
                            {"ULP1", "8.10", 4, 0},
                            {"ULP2", "8.5", 3, 1},
                            {"LPCN", "8.3", 0, 0, true},
                            {"LLP1", "8.7", -7, -2},
                            {"LLP2", "8.7", 4, -1},
                            {"CHN1", "mouth_chin_left", 0, 0},
                            {"CHN2", "2.10", 13, 0},
                            {"CHN3", "2.11", 0, 2},
                            {"JAW1", "cheek_low_left", -8, -20},
                            {"JAW2", "cheek_low_left", 4, -12},
                            {"JAW3", "5.1", 17, -22}};

static_assert(std::size(on_midline) == 13 && std::size(on_side) == 42);

// The skin that markers may sit on, as a mesh of its own with the way back.
struct Skin {
  std::shared_ptr<const Topology> topology;
  std::vector<int> parent_triangle;
};

Skin face_skin(const FaceFeatures& face) {
  const std::vector<bool> skin = face.members("face"), lids = face.members("lids");
  const Triangles& all = face.topology.triangles();
  Skin result;
  std::vector<Eigen::Vector3i> kept;
  for (Eigen::Index t = 0; t < all.rows(); ++t) {
    bool good = true;
    for (int c = 0; c < 3; ++c) good = good && skin[all(t, c)] && !lids[all(t, c)];
    if (!good) continue;
    kept.emplace_back(all.row(t).transpose());
    result.parent_triangle.push_back(static_cast<int>(t));
  }
  Triangles triangles(kept.size(), 3);
  for (std::size_t t = 0; t < kept.size(); ++t) triangles.row(t) = kept[t].transpose();
  result.topology = Topology::from_triangles(face.topology.vertex_count(), triangles);
  return result;
}

class Gluer {
 public:
  explicit Gluer(const FaceFeatures& face)
      : face_(face), skin_(face_skin(face)), scene_(*skin_.topology, face.positions) {}

  SurfacePoint place(const Eigen::Vector3d& near) const {
    const std::optional<ClosestPoint> found = scene_.closest(near);
    if (!found) throw InputError("marker layout: the face has no skin");
    SurfacePoint place = found->place;
    place.triangle = skin_.parent_triangle[place.triangle];
    return place;
  }

  SurfacePoint place(const Spot& spot, Side side, Random& random) const {
    const double lateral = side == Side::left ? 1.0 : -1.0, s = face_.scale;
    Eigen::Vector3d at = face_.at(spot.landmark, side) + s * Eigen::Vector3d(lateral * spot.x, spot.y, 0);
    const double dx = random.normal(), dy = random.normal();
    if (spot.anchor) return place(at);
    // Sideways steps leave the curved face: come back to it from the front and outside before gluing.
    const Eigen::Vector3d outward = Eigen::Vector3d(at.x(), 0, at.z() + 60 * s).normalized();
    at += 0.6 * Eigen::Vector3d(dx, dy, 0);
    if (const auto hit = scene_.hit(at + 80 * s * outward, -outward)) {
      SurfacePoint on = hit->place;
      on.triangle = skin_.parent_triangle[on.triangle];
      return on;
    }
    return place(at);
  }

 private:
  const FaceFeatures& face_;
  Skin skin_;
  RayScene scene_;
};

Points jig_targets(const FaceFeatures& face, Random& random) {
  struct Target {
    const char* landmark;
    Side side;
    double stand_off;
  };
  const Target targets[] = {{"11.1", Side::left, 24},
                            {"hairline_temple_left", Side::left, 20},
                            {"hairline_temple_left", Side::right, 20},
                            {"side_hair_front_left", Side::left, 30},
                            {"side_hair_front_left", Side::right, 22}};
  Points jig(std::size(targets), 3);
  const Eigen::Vector3d middle = 0.5 * (face.at("10.9") + face.at("10.9", Side::right));
  for (std::size_t i = 0; i < std::size(targets); ++i) {
    const Eigen::Vector3d at = face.at(targets[i].landmark, targets[i].side);
    const Eigen::Vector3d outward = (at - middle).normalized();
    const double x = random.uniform(-6, 6), y = random.uniform(-6, 6), z = random.uniform(-6, 6);
    jig.row(i) = (at + face.scale * (targets[i].stand_off * outward + Eigen::Vector3d(x, y, z))).transpose();
  }
  return jig;
}

}  // namespace

MarkerLayout marker_layout(const FaceModel& actor, std::uint64_t seed) {
  const FaceFeatures face(*actor.topology(), actor.neutral());
  const Gluer gluer(face);
  Random random(seed, 21);
  MarkerLayout layout;
  const auto add = [&](const Spot& spot, Side on, const std::string& label) {
    layout.labels.push_back(label);
    layout.places.push_back(gluer.place(spot, on, random));
    if (!spot.anchor) return;
    const int vertex = face.topology.landmarks().at(spot.landmark);
    const int own = on == Side::left ? vertex : face.mirror[vertex];
    for (const auto& [name, landmark] : face.topology.landmarks())
      if (landmark == own) layout.anchors[label] = name;
  };
  for (const Spot& spot : on_midline) add(spot, Side::left, spot.label);
  for (const Spot& spot : on_side) {
    add(spot, Side::left, std::string("L") + spot.label);
    add(spot, Side::right, std::string("R") + spot.label);
  }
  layout.jig = jig_targets(face, random);
  for (int j = 1; j <= layout.jig.rows(); ++j) layout.jig_labels.push_back("JIG" + std::to_string(j));
  return layout;
}

Points marker_positions(const MarkerLayout& layout, const Topology& topology, const Points& posed) {
  Points centres(layout.places.size(), 3);
  for (std::size_t m = 0; m < layout.places.size(); ++m) {
    const auto corners = topology.triangles().row(layout.places[m].triangle);
    const Eigen::Vector3d a = posed.row(corners[0]), b = posed.row(corners[1]), c = posed.row(corners[2]);
    const Eigen::Vector3d normal = (b - a).cross(c - a).normalized();
    centres.row(m) = (position_of(layout.places[m], topology, posed) + marker_radius * normal).transpose();
  }
  return centres;
}

}  // namespace vultus::virtual_stage
