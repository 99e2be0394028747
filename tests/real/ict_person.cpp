// One person out of ICT-FaceKit's modes, scanned by the virtual scanner, and the registered result held against the
// vertices that are known: registration sees only scans whose triangulation has nothing to do with the model's.
//
//   ict_person scan ICT_FOLDER CAPTURE TRUTH [POSE…]   writes CAPTURE/scans/<pose>.ply and TRUTH/<pose>.ply
//   ict_person compare TRUTH ACTOR REPORT.json         distance of every face vertex to the true one, pose by pose

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/virtual_stage/scanner.h"
#include "core/error.h"
#include "core/files.h"
#include "core/mesh.h"
#include "core/mesh_io.h"
#include "core/transform.h"
#include "rig/actor.h"

namespace {

using namespace vultus;
namespace fs = std::filesystem;

constexpr double mm_from_ict = 10.0;      // the folder is in centimetres
constexpr int outer_skin_vertices = 11248;  // face, head and neck (its README)
constexpr int eyeballs_begin = 21451, eyeballs_end = 24591;
constexpr std::uint64_t person_seed = 7;

const std::vector<std::string> default_poses = {"neutral",     "jawOpen",    "mouthSmile_L", "mouthFunnel", "mouthPucker",
                                                "browInnerUp_L", "eyeBlink_L", "cheekPuff_L",  "noseSneer_R"};

Points ict_positions(const fs::path& folder, const std::string& name) {
  return read_mesh(folder / (name + ".obj")).positions * mm_from_ict;
}

/// Mean face plus the five identity modes with fixed coefficients of an ordinary person.
Points person_neutral(const fs::path& folder, const Points& generic) {
  const std::array<double, 5> coefficients = {0.8, -1.1, 0.6, 1.2, -0.7};
  Points person = generic;
  for (int mode = 0; mode < 5; ++mode)
    person += coefficients[mode] * (ict_positions(folder, "identity00" + std::to_string(mode)) - generic);
  return person;
}

void scan(const fs::path& folder, const fs::path& capture, const fs::path& truth, std::vector<std::string> poses) {
  if (poses.empty()) poses = default_poses;
  Mesh generic = read_mesh(folder / "generic_neutral_mesh.obj");
  generic.positions *= mm_from_ict;
  const Points neutral = person_neutral(folder, generic.positions);
  std::vector<bool> visible(generic.positions.rows());
  for (int v = 0; v < static_cast<int>(visible.size()); ++v)
    visible[v] = v < outer_skin_vertices || (v >= eyeballs_begin && v < eyeballs_end);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    Mesh person = generic;
    person.positions = neutral;
    if (poses[i] != "neutral") person.positions += ict_positions(folder, poses[i]) - generic.positions;
    write_ply(truth / (poses[i] + ".ply"), person);
    virtual_stage::ScanOptions options;
    options.seed = person_seed + i;
    options.triangles = 160'000;
    const virtual_stage::Scan result = virtual_stage::scan_subject({sub_mesh(person, visible).mesh, {}}, options);
    write_ply(capture / "scans" / (poses[i] + ".ply"), result.mesh);
    std::cerr << "scanned " << poses[i] << "\n";
  }
}

double quantile(std::vector<double> values, double q) {
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

Points rows(const Points& all, const std::vector<int>& chosen) {
  Points some(chosen.size(), 3);
  for (std::size_t i = 0; i < chosen.size(); ++i) some.row(i) = all.row(chosen[i]);
  return some;
}

/// The registered face frame differs from the model's by a rigid motion that no scan can tell, so one motion is fitted
/// for each pose before vertices are compared.
void compare(const fs::path& truth, const fs::path& actor_folder, const fs::path& report) {
  const rig::Actor actor = rig::load_actor(actor_folder);
  const std::vector<int>& face = actor.topology->set("face");
  nlohmann::json poses = nlohmann::json::array();
  for (const rig::Pose& pose : actor.poses) {
    if (!fs::exists(truth / (pose.name + ".ply"))) continue;
    const Points known = rows(read_mesh(truth / (pose.name + ".ply")).positions, face);
    const Points found = rows(pose.positions, face);
    const Points aligned = transformed(fit_similarity(found, known, Scaling::fixed), found);
    const Eigen::VectorXd distance = (aligned - known).rowwise().norm();
    const std::vector<double> sorted(distance.data(), distance.data() + distance.size());
    poses.push_back({{"pose", pose.name}, {"vertex_median_mm", quantile(sorted, 0.5)}, {"vertex_p95_mm", quantile(sorted, 0.95)}});
    std::printf("%-16s median %.2f mm  p95 %.2f mm\n", pose.name.c_str(), quantile(sorted, 0.5), quantile(sorted, 0.95));
  }
  if (poses.empty()) throw InputError(actor_folder, "has no pose of " + truth.string());
  write_json(report, {{"poses", poses}});
}

}  // namespace

int main(int argc, char** argv) try {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  if (arguments.size() >= 4 && arguments[0] == "scan")
    scan(arguments[1], arguments[2], arguments[3], {arguments.begin() + 4, arguments.end()});
  else if (arguments.size() == 4 && arguments[0] == "compare")
    compare(arguments[1], arguments[2], arguments[3]);
  else
    throw UsageError("ict_person scan ICT_FOLDER CAPTURE TRUTH [POSE…] | ict_person compare TRUTH ACTOR REPORT.json");
  return 0;
} catch (const vultus::Error& error) {
  std::cerr << error.what() << "\n";
  return 2;
}
