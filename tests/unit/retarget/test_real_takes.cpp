// The AnimFace takes on ICT-FaceKit's mean face; runs where VULTUS_DATA has both.
#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>

#include "mocap/stabilize.h"
#include "retarget/errors.h"
#include "retarget/face.h"
#include "retarget/regional.h"
#include "rig/databank.h"

namespace vultus::retarget {
namespace {

namespace fs = std::filesystem;

fs::path data_folder() {
  const char* folder = std::getenv("VULTUS_DATA");
  return folder == nullptr ? fs::path() : fs::path(folder);
}

/// Twelve soft regions around points of the 68-point scheme, 15 mm wide.
void add_regions(rig::Actor& actor) {
  const std::vector<int> centres = {19, 24, 36, 45, 30, 48, 54, 51, 57, 8, 2, 14};
  Eigen::MatrixXf masks(actor.topology->vertex_count(), static_cast<Eigen::Index>(centres.size()));
  for (std::size_t k = 0; k < centres.size(); ++k) {
    const Eigen::RowVector3d centre = actor.neutral().row((*actor.ibug68)[centres[k]]);
    const Eigen::VectorXd squared = (actor.neutral().rowwise() - centre).rowwise().squaredNorm();
    masks.col(static_cast<Eigen::Index>(k)) = ((-squared.array() / 450.0).exp() + 1e-12).matrix().cast<float>();
  }
  for (Eigen::Index v = 0; v < masks.rows(); ++v) masks.row(v) /= masks.row(v).sum();
  for (std::size_t k = 0; k < centres.size(); ++k) {
    actor.regions.push_back({"ibug" + std::to_string(centres[k]), masks.col(static_cast<Eigen::Index>(k))});
  }
}

rig::MarkerPlaces anchors(const rig::Actor& actor) {
  const std::map<std::string, int> points = {
      {"Leyebrow_Inside", 22}, {"Leyebrow_Outside", 26}, {"Reyebrow_Inside", 21}, {"Reyebrow_Outside", 17},
      {"NoseTop", 27},         {"NoseHead", 30},         {"Leye_Inside", 42},     {"Leye_Outside", 45},
      {"Reye_Inside", 39},     {"Reye_Outside", 36},     {"Mouth_Up", 51},        {"Mouth_Down", 57},
      {"Mouth_Lend", 54},      {"Mouth_Rend", 48},       {"Chin", 8}};
  rig::MarkerPlaces places;
  for (const auto& [label, point] : points) {
    places[label] = rig::place_of_vertex(*actor.topology, (*actor.ibug68)[point]);
  }
  return places;
}

TEST(RealTakes, RegionsComeCloserThanTheWholeFace) {
  const fs::path data = data_folder();
  if (!fs::exists(data / "ict-facekit") || !fs::exists(data / "animface-markers")) GTEST_SKIP() << "no VULTUS_DATA";
  rig::Actor actor = rig::read_ict_facekit(data / "ict-facekit").actor;
  ASSERT_TRUE(actor.ibug68.has_value());
  add_regions(actor);
  const auto stabilized = mocap::stabilize(mocap::read_take(data / "animface-markers" / "Jaw.c3d"));
  const mocap::Take& take = stabilized.take;
  const auto placement = place_markers(take.labels, take.frame(stabilized.reference_frame), anchors(actor), actor);
  EXPECT_EQ(placement.labels.size(), 41u);
  EXPECT_NEAR(placement.rig_from_mocap.scale, 0.9, 0.1);  // two adult heads

  const mocap::Take moved = to_rig(take, placement, rig_from_mocap(placement));
  const MarkerBasis basis = basis_from_surface(actor, placement.labels, placement.places);
  const MarkerWeights global = MarkerWeights::global(placement.labels);
  const MarkerWeights regional = marker_weights(actor, placement.labels, placement.places);
  const SolveResult whole = solve_take(moved, basis, global), split = solve_take(moved, basis, regional);
  EXPECT_LE(whole.worst_kkt_residual, 1e-9);
  EXPECT_LE(split.worst_kkt_residual, 1e-9);
  const double whole_mean = summarize(marker_errors(moved, basis, global, whole.weights), "global", 1).mean;
  const double split_mean = summarize(marker_errors(moved, basis, regional, split.weights), "12 regions", 12).mean;
  EXPECT_LT(whole_mean, 1.5);             // measured 0.91 mm; the reference frame itself is 0
  EXPECT_LT(split_mean, 0.9 * whole_mean);  // measured 0.71 mm

  // The neutral frame maps onto the neutral exactly, so its weights and face are the rig's neutral.
  const Face face(actor, split.weights.poses, split.weights.regions);
  const Points still = face.at(split.weights, stabilized.reference_frame);
  EXPECT_LE((still - actor.neutral()).rowwise().norm().maxCoeff(), 0.05);
}

}  // namespace
}  // namespace vultus::retarget
