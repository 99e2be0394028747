#include "apps/virtual_stage/stage.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "apps/virtual_stage/expressions.h"
#include "apps/virtual_stage/fault_truth.h"
#include "apps/virtual_stage/mocap_volume.h"
#include "apps/virtual_stage/virtual_actor.h"
#include "core/array_io.h"
#include "core/error.h"
#include "core/files.h"
#include "core/mesh_io.h"
#include "core/random.h"
#include "register/template_head.h"

namespace vultus::virtual_stage {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

void check(bool in_range, const std::string& option, const std::string& range) {
  if (!in_range) throw UsageError("simulate: " + option + " must be " + range);
}

// Seeds that differ for each part of the stage, so that one part's choices leave the others as they were.
std::uint64_t sub_seed(std::uint64_t seed, std::uint64_t part) { return seed * 1'000'003 + part; }

std::vector<std::string> pose_list(const StageOptions& options) {
  std::vector<std::string> names = {"neutral"};
  for (const Expression& e : expression_database())
    if (e.name != "neutral" && (options.poses.empty() || std::ranges::count(options.poses, e.name) > 0))
      names.push_back(e.name);
  return names;
}

json matrix_json(const Similarity& pose) {
  json rows = json::array();
  for (int r = 0; r < 3; ++r)
    rows.push_back({pose.rotation(r, 0), pose.rotation(r, 1), pose.rotation(r, 2), pose.translation[r]});
  return rows;
}

// The face model's vertices on the fine surface: what a perfect registration would find.
Mesh registered(const FaceModel& face, const Points& fine) {
  Mesh mesh;
  mesh.topology = face.topology();
  mesh.positions = fine.topRows(face.topology()->vertex_count());
  return mesh;
}

void write_clicked_landmarks(const fs::path& file, const registration::Template& head, const Points& positions,
                             std::uint64_t seed) {
  Random random(seed, 51);
  json points = json::object();
  for (const registration::Landmark& landmark : head.landmarks) {
    if (!landmark.major) continue;
    json& point = points[landmark.name] = json::array();
    for (int axis = 0; axis < 3; ++axis) point.push_back(positions(landmark.vertex, axis) + random.normal());
  }
  write_json(file, {{"points", points}});
}

// Of one pose's scan: the same whichever other poses are scanned too.
std::uint64_t pose_seed(const StageOptions& options, const std::string& pose) {
  const std::vector<Expression>& all = expression_database();
  const auto found = std::ranges::find(all, pose, &Expression::name);
  return sub_seed(options.seed, 100 + static_cast<std::uint64_t>(found - all.begin()));
}

json scan_pose(const fs::path& folder, const VisibleActor& visible, const VirtualActor& actor, const std::string& name,
               const StageOptions& options) {
  const auto [subject, scan] = stage_scan(visible, name, options);
  write_ply(folder / "capture" / "scans" / (name + ".ply"), scan.mesh);
  Mesh truth = registered(actor.face(), subject.surface.positions);
  write_ply(folder / "truth" / "poses" / (name + ".ply"), truth);
  truth.positions = transformed(scan.scan_from_face, truth.positions);
  write_ply(folder / "truth" / "scans" / (name + ".ply"), truth);
  if (options.landmarks)
    write_clicked_landmarks(folder / "capture" / "landmarks" / (name + ".json"), actor.head(), truth.positions,
                            pose_seed(options, name));
  return {{"scan_from_face", matrix_json(scan.scan_from_face)}};
}

json scan_session(const fs::path& folder, const registration::Template& head, const StageOptions& options,
                  Progress& progress) {
  const std::vector<std::string> names = pose_list(options);
  progress.begin("scans", names.size());
  const VirtualActor actor = scanned_actor(head, options);
  const VisibleActor visible(actor);
  write_image(folder / "truth" / "albedo.exr", visible.albedo());
  std::vector<json> truths(names.size());
  tbb::parallel_for(std::size_t{0}, names.size(), [&](std::size_t i) {
    progress.check();
    // Isolated: a thread waiting inside one scan must not start another, or memory grows with the number of poses.
    tbb::this_task_arena::isolate([&] { truths[i] = scan_pose(folder, visible, actor, names[i], options); });
    progress.advance();
  });
  json poses = json::object(), truth = json::object();
  for (std::size_t i = 0; i < names.size(); ++i) {
    poses[names[i]] = {{"scan", "scans/" + names[i] + ".ply"}, {"tags", expression(names[i]).tags}};
    truth[names[i]] = truths[i];
    const Activations& a = expression(names[i]).activations;
    truth[names[i]]["activations"] = std::vector<double>(a.begin(), a.end());
  }
  write_json(folder / "capture" / "capture.json", {{"units", "mm"}, {"up", "y"}, {"poses", poses}});
  return truth;
}

void write_truth(const fs::path& folder, const Performance& performance, const RecordedTake& recorded) {
  mocap::write_take(folder / "clean.c3d", recorded.clean);
  const std::size_t frames = performance.frames.size();
  Array activations = Array::zeros({frames, static_cast<std::size_t>(channel_count)});
  Array poses = Array::zeros({frames, 3, 4});
  for (std::size_t f = 0; f < frames; ++f) {
    for (int c = 0; c < channel_count; ++c)
      activations.values[f * channel_count + c] = static_cast<float>(performance.frames[f][c]);
    const Similarity& pose = recorded.volume_from_face[f];
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 4; ++c)
        poses.values[f * 12 + 4 * r + c] = static_cast<float>(c < 3 ? pose.rotation(r, c) : pose.translation[r]);
  }
  write_npy(folder / "activations.npy", activations);
  write_npy(folder / "head_poses.npy", poses);
}

void write_plans(const fs::path& folder, const MarkerLayout& layout, const TrainingSession& training) {
  json poses = json::object();
  for (const Hold& hold : training.holds) poses[hold.pose] = {hold.first, hold.last};
  write_json(folder / "training.json", {{"take", "training"}, {"poses", poses}});
  write_json(folder / "markers.json", {{"anchors", layout.anchors}, {"jig", layout.jig_labels}});
}

// What the cameras gave, as a tracker delivers it.
void deliver_take(const fs::path& folder, const RecordedTake& recorded, int jig_markers, double faults,
                  std::uint64_t seed) {
  const std::string& name = recorded.take.name;
  const fs::path file = folder / "capture" / "mocap" / (name + ".c3d");
  if (faults <= 0.0) {
    mocap::write_take(file, recorded.take);
    return;
  }
  const FaultyTake faulty = with_faults(recorded, jig_markers, usual_faults(seed, faults));
  mocap::write_take(file, faulty.take);
  write_fault_truth(folder / "truth" / "mocap" / name, recorded, faulty);
}

void perform_takes(const fs::path& folder, const FaceModel& face, const MarkerLayout& layout,
                   const std::vector<Performance>& performances, const StageOptions& options, Progress& progress) {
  for (std::size_t i = 0; i < performances.size(); ++i) {
    progress.check();
    VolumeOptions volume;
    volume.seed = sub_seed(options.seed, 200 + i);
    volume.noise = options.marker_noise;
    volume.missing = options.marker_missing;
    volume.head_motion = i == 0 ? 0.35 : 1.0;  // who shows poses one by one sits still
    const RecordedTake recorded = record(face, layout, performances[i], volume);
    write_truth(folder / "truth" / "mocap" / performances[i].name, performances[i], recorded);
    deliver_take(folder, recorded, static_cast<int>(layout.jig.rows()), options.faults, volume.seed);
    progress.advance();
  }
}

void mocap_session(const fs::path& folder, const registration::Template& head, const StageOptions& options,
                   Progress& progress) {
  const std::vector<std::string> names = options.performances.empty() ? performance_names() : options.performances;
  progress.begin("mocap", names.size() + 2);
  constexpr double rate_hz = 120.0;
  const VirtualActor actor(head, sub_seed(options.seed, 2));
  const std::vector<std::string> poses = pose_list(options);
  for (const std::string& pose : poses) {
    const Mesh mesh{actor.face().topology(), actor.face().pose(expression(pose).activations), {}, {}};
    write_ply(folder / "truth" / "mocap" / "poses" / (pose + ".ply"), mesh);
  }
  const MarkerLayout layout = marker_layout(actor.face(), sub_seed(options.seed, 3));
  const TrainingSession training = training_session(poses, options.hold_seconds, rate_hz, sub_seed(options.seed, 4));
  write_plans(folder / "capture" / "mocap", layout, training);
  progress.advance();
  std::vector<Performance> performances = {training.performance};
  for (const std::string& name : names)
    performances.push_back(perform(name, options.performance_seconds, rate_hz, sub_seed(options.seed, 5)));
  perform_takes(folder, actor.face(), layout, performances, options, progress);
}

}  // namespace

void StageOptions::validate() const {
  ScanOptions scan;
  scan.triangles = scan_triangles;
  scan.noise = scan_noise;
  scan.validate();
  VolumeOptions volume;
  volume.noise = marker_noise;
  volume.missing = marker_missing;
  volume.validate();
  check(performance_seconds >= 1 && performance_seconds <= 600, "performance_seconds", "1 … 600");
  check(faults >= 0 && faults <= 20, "faults", "0 … 20");
  check(hold_seconds >= 0.2 && hold_seconds <= 10, "hold_seconds", "0.2 … 10");
  for (const std::string& pose : poses) expression(pose);
  for (const std::string& name : performances) perform(name, 1.0, 30.0, 0);
}

VirtualActor scanned_actor(const registration::Template& head, const StageOptions& options) {
  return VirtualActor(head, sub_seed(options.seed, 1));
}

StagedScan stage_scan(const VisibleActor& visible, const std::string& pose, const StageOptions& options) {
  StagedScan staged;
  staged.subject = visible.subject(expression(pose).activations);
  ScanOptions scan_options;
  scan_options.seed = pose_seed(options, pose);
  scan_options.triangles = options.scan_triangles;
  scan_options.noise = options.scan_noise;
  scan_options.clutter = options.clutter;
  staged.scan = scan_subject(staged.subject, scan_options);
  return staged;
}

void simulate(const fs::path& folder, const StageOptions& options, Progress& progress) {
  options.validate();
  const registration::Template head = registration::template_head();
  const json scans = scan_session(folder, head, options, progress);
  if (options.mocap) mocap_session(folder, head, options, progress);
  write_json(folder / "truth" / "truth.json",
             {{"seed", options.seed}, {"units", "mm"}, {"channels", channel_names()}, {"scans", scans}});
}

}  // namespace vultus::virtual_stage
