// Holds what `vultus demo DIR` found against DIR/truth and the figures it must reach: one "ok" or "FAILED" line a check.
//   demo_truth DIR

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/files.h"
#include "core/mesh_io.h"
#include "core/transform.h"
#include "mocap/take.h"
#include "rig/actor.h"

namespace {

using namespace vultus;
namespace fs = std::filesystem;

int failures = 0;

void check(bool good, const std::string& what) {
  std::printf("%s %s\n", good ? "ok" : "FAILED", what.c_str());
  if (!good) ++failures;
}

std::string text(const char* format, const std::string& name, double a, double b) {
  char line[200];
  std::snprintf(line, sizeof line, format, name.c_str(), a, b);
  return line;
}

double quantile(std::vector<double> values, double q) {
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

Points rows(const Points& all, const std::vector<int>& chosen) {
  Points some(static_cast<Eigen::Index>(chosen.size()), 3);
  for (std::size_t i = 0; i < chosen.size(); ++i) some.row(static_cast<Eigen::Index>(i)) = all.row(chosen[i]);
  return some;
}

void check_distances(const fs::path& demo) {
  const nlohmann::json report = read_json(demo / "actor/report/registration.json");
  double worst = 0.0;
  std::string worst_pose;
  for (const auto& pose : report.at("poses")) {
    const double mean = pose.at("distance_mm").at("mean");
    if (mean <= worst) continue;
    worst = mean;
    worst_pose = pose.at("pose");
  }
  check(report.at("poses").size() >= 22, "22 scanned poses or more are in the actor");
  check(worst > 0.0 && worst <= 0.3, text("scan to mesh in the face: worst pose %s, mean %.3f mm (<= %.1f)", worst_pose, worst, 0.3));
}

/// The face frame is fixed by what is found, so one rigid motion is taken out of each pose.
void check_vertices(const fs::path& demo) {
  const rig::Actor actor = rig::load_actor(demo / "actor");
  const std::vector<int>& face = actor.topology->set("face");
  std::vector<double> medians, tails;
  for (const rig::Pose& pose : actor.poses) {
    const Points known = rows(read_mesh(demo / "truth/poses" / (pose.name + ".ply")).positions, face);
    const Points found = rows(pose.positions, face);
    const Eigen::VectorXd d = (transformed(fit_similarity(found, known, Scaling::fixed), found) - known).rowwise().norm();
    const std::vector<double> distance(d.data(), d.data() + d.size());
    medians.push_back(quantile(distance, 0.5));
    tails.push_back(quantile(distance, 0.95));
    std::printf("   %-16s to the true vertex: median %.2f mm, 95 %% %.2f mm\n", pose.name.c_str(), medians.back(), tails.back());
  }
  // A mesh that lies on the scan with slid vertices would pass the distance above; 1.5 mm is the spacing of vertices.
  check(quantile(medians, 0.5) <= 1.5, text("%s: median pose %.2f mm at the median vertex (<= %.1f)", "true vertices", quantile(medians, 0.5), 1.5));
}

/// Head motion out: what is left between cleaned and true markers after one rigid motion for the whole take.
void check_markers(const fs::path& demo, const std::string& take) {
  const mocap::Take clean = mocap::read_take(demo / "session/takes" / take / "clean.c3d");
  const mocap::Take truth = mocap::read_take(demo / "truth/mocap" / take / "clean.c3d");
  std::vector<Eigen::Vector3d> found, known;
  for (int marker = 0; marker < clean.markers(); ++marker) {
    const int same = truth.find(clean.labels[marker]);
    for (int frame = 0; same >= 0 && frame < std::min(clean.frames(), truth.frames()); frame += 7) {
      if (!clean.has(frame, marker) || !truth.has(frame, same)) continue;
      found.push_back(clean.at(frame, marker));
      known.push_back(truth.at(frame, same));
    }
  }
  Points a(static_cast<Eigen::Index>(found.size()), 3), b(a.rows(), 3);
  for (Eigen::Index i = 0; i < a.rows(); ++i) {
    a.row(i) = found[static_cast<std::size_t>(i)];
    b.row(i) = known[static_cast<std::size_t>(i)];
  }
  check(a.rows() > 10000, take + ": markers of the truth are in the cleaned take");
  const Eigen::VectorXd d = (transformed(fit_similarity(a, b, Scaling::fixed), a) - b).rowwise().norm();
  const double rms = std::sqrt(d.squaredNorm() / static_cast<double>(d.size()));
  // 0.1 mm noise on three coordinates alone leaves 0.17 mm; head motion left in would be tens of millimetres.
  check(rms <= 0.6, text("%s: cleaned markers are %.2f mm RMS from the truth (<= %.1f)", take, rms, 0.6));
}

void check_table(const fs::path& demo, const std::string& take) {
  const nlohmann::json table = read_json(demo / "session/takes" / take / "report.json").at("table");
  const double global = table.at(0).at("mean_mm");
  for (std::size_t row = 1; row < table.size(); ++row) {
    const double regional = table.at(row).at("mean_mm");
    check(regional < global, text(("%s, " + table[row].at("name").get<std::string>() + ": mean marker error %.3f mm, globally %.3f").c_str(),
                                  take, regional, global));
  }
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 2) throw UsageError("demo_truth DIR");
  const fs::path demo = argv[1];
  check_distances(demo);
  check_vertices(demo);
  for (const std::string take : {"speech", "emotions", "asymmetry"}) {
    check_markers(demo, take);
    check_table(demo, take);
  }
  return failures == 0 ? 0 : 1;
} catch (const std::exception& error) {
  std::printf("FAILED %s\n", error.what());
  return 1;
}
