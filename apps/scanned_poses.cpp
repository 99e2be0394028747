#include "apps/scanned_poses.h"

#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <mutex>
#include <optional>

#include "apps/memory_budget.h"
#include "apps/pose_picture.h"
#include "apps/registration_report.h"
#include "apps/scan_file.h"
#include "core/array_io.h"
#include "core/error.h"
#include "core/files.h"
#include "core/image.h"
#include "core/mesh_io.h"
#include "register/landmarks.h"
#include "register/texture_transfer.h"
#include "render/face_look.h"

namespace vultus::apps {
namespace {

namespace fs = std::filesystem;
using registration::Registered;

// The scan's colour in texture space, or an empty image; parts that a scan does not show look as their names tell.
Image albedo_of(const Registered& registered, Mesh scan) {
  const Topology& topology = *registered.mesh.topology;
  if (!topology.has_uvs() || !registration::has_colour(scan)) return {};
  scan.positions = transformed(registered.face_from_scan, scan.positions);
  return registration::transfer_colours(registered.mesh, scan,
                                        render::face_look(topology, registered.mesh.positions).colours);
}

// Stages of several scans at once would overwrite each other's bars; only cancelling passes through.
class Background final : public Progress {
 public:
  explicit Background(const Progress& foreground) : foreground_(foreground) {}
  void begin(std::string_view, std::size_t) override {}
  void advance(std::size_t) override {}
  void note(std::string_view) override {}
  bool cancelled() const override { return foreground_.cancelled(); }

 private:
  const Progress& foreground_;
};

// A scan ready for registration.
struct Prepared {
  scan::CleanScan scan;
  std::optional<registration::ScanLandmarks> landmarks;
};

struct Attempt {
  std::optional<Registered> registered;
  Mesh scan;     // of the neutral: its colours are wanted, too
  Image albedo;  // of a coloured neutral
  Image picture;
  std::vector<std::string> cleaning;
  std::string problem;
};

struct Work {
  CapturedPose pose;
  Provenance provenance;
};

class Scans {
 public:
  Scans(const Capture& capture, const registration::Registration& registration, Progress& progress)
      : capture_(capture), registration_(registration), background_(progress) {}

  Attempt neutral(const CapturedPose& pose) {
    Prepared prepared = prepare(pose);
    Attempt attempt;
    attempt.registered = registration_.neutral(prepared.scan, prepared.landmarks, background_);
    attempt.albedo = albedo_of(*attempt.registered, prepared.scan.mesh);
    attempt.cleaning = prepared.scan.report.lines();
    attempt.picture = pose_picture(prepared.scan, *attempt.registered);
    attempt.scan = std::move(prepared.scan.mesh);
    return attempt;
  }

  Attempt expression(const Registered& neutral, const CapturedPose& pose) {
    Attempt attempt;
    try {
      const Prepared prepared = prepare(pose);
      attempt.registered = registration_.expression(neutral, prepared.scan, prepared.landmarks, background_);
      attempt.cleaning = prepared.scan.report.lines();
      attempt.picture = pose_picture(prepared.scan, *attempt.registered);
    } catch (const InputError& error) {
      attempt.problem = error.what();
    }
    return attempt;
  }

 private:
  Prepared prepare(const CapturedPose& pose) {
    scan::CleanOptions options;
    options.mm_per_unit = capture_.mm_per_unit;
    Prepared result{clean_scan_file(pose.scan, options, background_, capture_.upright), {}};
    if (!pose.landmarks.empty()) {
      result.landmarks = registration::read_landmarks(pose.landmarks, result.scan.report.units.mm_per_unit);
      for (auto& landmark : *result.landmarks) landmark.position = capture_.upright * landmark.position;
    }
    return result;
  }

  const Capture& capture_;
  const registration::Registration& registration_;
  Background background_;
};

std::string report_name(const std::string& pose) { return "report/" + pose + ".json"; }
std::string distance_name(const std::string& pose) { return "report/" + pose + ".distance.npy"; }
constexpr const char* albedo_name = "maps/neutral/albedo.exr";
std::string picture_name(const std::string& pose) { return "report/" + pose + ".png"; }

// A scan that cannot be read is reported when its turn comes.
std::string texture_of(const fs::path& scan) {
  try {
    return read_mesh(scan, NonFinite::keep).texture;
  } catch (const InputError&) {
    return {};
  }
}

void add_scan_inputs(const CapturedPose& pose, const std::string& prefix, std::map<std::string, std::string>& inputs) {
  inputs[prefix + "scan"] = sha256_of_file(pose.scan);
  if (!pose.landmarks.empty()) inputs[prefix + "landmarks"] = sha256_of_file(pose.landmarks);
  const std::string texture = texture_of(pose.scan);
  if (fs::is_regular_file(texture)) inputs[prefix + "texture"] = sha256_of_file(texture);
}

class Writer {
 public:
  explicit Writer(rig::ActorWriter& actor) : actor_(actor) {}

  bool is_current(const Work& work) const {
    const std::string& name = work.pose.name;
    if (!actor_.pose_is_current(name, work.provenance)) return false;
    std::vector<std::string> files{report_name(name), distance_name(name), picture_name(name)};
    if (name == "neutral" && actor_.manifest().has(albedo_name)) files.emplace_back(albedo_name);
    return std::all_of(files.begin(), files.end(),
                       [&](const auto& file) { return actor_.manifest().is_current(file, work.provenance); });
  }

  /// The colour of the neutral's scan in texture space, where it has any.
  void write_albedo(const Work& work, const Attempt& neutral) {
    Mesh scan = neutral.scan;
    const Registered& registered = *neutral.registered;
    if (!registration::has_colour(scan) || !registered.mesh.topology->has_uvs()) {
      actor_.manifest().forget(albedo_name);
      return;
    }
    scan.positions = transformed(registered.face_from_scan, scan.positions);
    const Points unseen = render::face_look(*registered.mesh.topology, registered.mesh.positions).colours;
    actor_.write_map("neutral", "albedo", registration::transfer_colours(registered.mesh, scan, unseen),
                     work.provenance);
  }

  void write(const Work& work, const Attempt& attempt, Progress& progress) {
    const Registered& registered = *attempt.registered;
    const std::string& name = work.pose.name;
    nlohmann::json report = pose_report(work.pose, registered, attempt.cleaning);
    report["picture"] = picture_name(name);
    const auto& distance = registered.quality.vertex_distance;
    Manifest& manifest = actor_.manifest();
    write_json(manifest.folder() / report_name(name), report);
    write_npy(manifest.folder() / distance_name(name),
              {{static_cast<std::size_t>(distance.size())}, {distance.data(), distance.data() + distance.size()}});
    write_image(manifest.folder() / picture_name(name), attempt.picture);
    for (const std::string& file : {report_name(name), distance_name(name), picture_name(name)}) {
      manifest.record(file, work.provenance);
    }
    if (!attempt.albedo.empty()) actor_.write_map(name, "albedo", attempt.albedo, work.provenance);
    actor_.write_pose({name, work.pose.tags, registered.mesh.positions}, work.provenance);
    progress.note(summary_line(report));
    const std::string advice = report.at("landmark_advice");
    if (!advice.empty()) progress.note(advice);
  }

 private:
  rig::ActorWriter& actor_;
};

std::vector<Work> work_for(const Capture& capture, const std::vector<CapturedPose>& poses,
                           const std::string& template_hash, const std::string& method) {
  std::vector<Work> work;
  std::map<std::string, std::string> neutral_inputs;
  add_scan_inputs(poses.front(), "", neutral_inputs);
  const std::vector<double> upright(capture.upright.data(), capture.upright.data() + 9);
  for (const CapturedPose& pose : poses) {
    Provenance provenance{
        "onboard",
        {{"method", method}, {"mm_per_unit", capture.mm_per_unit}, {"upright", upright}, {"tags", pose.tags}},
        {{"template", template_hash}}};
    if (&pose == &poses.front())
      provenance.inputs.insert(neutral_inputs.begin(), neutral_inputs.end());
    else
      add_scan_inputs(pose, "", provenance.inputs);
    for (const auto& [label, hash] : neutral_inputs) {
      if (&pose != &poses.front()) provenance.inputs["neutral " + label] = hash;
    }
    work.push_back({pose, provenance});
  }
  return work;
}

std::string gigabytes(std::uint64_t bytes) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f GB", static_cast<double>(bytes) / 1e9);
  return text;
}

// Four fifths of what is available, unless told; said in the log.
std::uint64_t memory_budget(std::uint64_t told, const std::vector<std::uint64_t>& costs, std::size_t threads,
                            Progress& progress) {
  const std::uint64_t available = available_memory();
  const std::uint64_t budget = told > 0 ? told : available > 0 ? available / 5 * 4 : 4'000'000'000;
  progress.note("memory: up to " + gigabytes(budget) + (told > 0 ? "" : " of " + gigabytes(available) + " available") +
                ", " + std::to_string(most_at_once(costs, budget, threads)) + " of " + std::to_string(costs.size()) +
                " scans side by side");
  return budget;
}

void register_expressions(const std::vector<Work>& work, Scans& scans, const Registered& neutral,
                          std::uint64_t memory_bytes, Writer& output, Progress& progress, ScannedPoses& result) {
  if (work.empty()) return;
  std::vector<std::uint64_t> costs;
  for (const Work& one : work) costs.push_back(memory_for_scan(one.pose.scan));
  const auto threads = static_cast<std::size_t>(std::max(1, tbb::this_task_arena::max_concurrency()));
  const std::uint64_t budget = memory_budget(memory_bytes, costs, threads, progress);
  for (std::size_t i = 0; i < work.size(); ++i)
    if (costs[i] > budget)
      progress.note(work[i].pose.name + ": may take " + gigabytes(costs[i]) + ", more than allowed; runs alone");
  std::mutex writing;
  std::vector<std::string> problems(work.size());
  run_within(budget, costs, threads, [&](std::size_t i) {
    progress.check();
    const Attempt attempt = scans.expression(neutral, work[i].pose);
    const std::scoped_lock lock(writing);
    if (attempt.registered) {
      output.write(work[i], attempt, progress);
      ++result.registered;
    } else {
      problems[i] = work[i].pose.name + ": " + attempt.problem;
    }
    progress.advance();
  });
  std::copy_if(problems.begin(), problems.end(), std::back_inserter(result.failed), [](auto& p) { return !p.empty(); });
}

// Nothing goes on without the neutral; the message says whose scan it was.
Attempt neutral_of(Scans& scans, const CapturedPose& pose) {
  try {
    return scans.neutral(pose);
  } catch (const InputError& problem) {
    const std::string reason = problem.what();
    if (reason.find(pose.scan.string()) != std::string::npos) throw;
    throw InputError(pose.scan, unregistered_report(pose.name, reason).at("reason").get<std::string>());
  }
}

}  // namespace

bool is_report_of(const std::string& pose, const std::string& artefact) {
  return artefact == report_name(pose) || artefact == distance_name(pose) || artefact == picture_name(pose);
}

ScannedPoses register_scans(const Capture& capture, const std::vector<CapturedPose>& poses,
                            const registration::Registration& registration, const std::string& template_hash,
                            const std::string& method, std::uint64_t memory_bytes, rig::ActorWriter& writer,
                            Progress& progress) {
  ScannedPoses result;
  Writer output(writer);
  std::vector<Work> stale;
  for (Work& work : work_for(capture, poses, template_hash, method)) {
    if (output.is_current(work))
      ++result.reused;
    else
      stale.push_back(std::move(work));
  }
  if (stale.empty()) return result;

  progress.begin("registering scans", stale.size());
  Scans scans(capture, registration, progress);
  // Expressions start from the neutral's result, which is not on disk in full: it is found again, the same.
  const Attempt neutral = neutral_of(scans, poses.front());
  std::size_t next = 0;
  if (stale.front().pose.name == poses.front().name) {
    output.write_albedo(stale.front(), neutral);
    output.write(stale.front(), neutral, progress);
    progress.advance();
    ++result.registered;
    next = 1;
  }
  const std::vector<Work> expressions(stale.begin() + static_cast<std::ptrdiff_t>(next), stale.end());
  register_expressions(expressions, scans, *neutral.registered, memory_bytes, output, progress, result);
  return result;
}

std::string hash_of(const registration::Template& head) {
  const TopologyData& data = head.topology->data();
  nlohmann::json names = {
      {"name", head.name}, {"subdivisions", head.subdivisions}, {"sets", data.sets}, {"landmarks", data.landmarks}};
  if (head.ibug68) names["ibug68"] = *head.ibug68;
  for (const registration::Landmark& landmark : head.landmarks)
    names["points"].push_back({landmark.name, landmark.vertex, landmark.major});
  std::string bytes = names.dump();
  const auto add = [&](const void* values, std::size_t size) { bytes.append(static_cast<const char*>(values), size); };
  add(head.neutral.data(), static_cast<std::size_t>(head.neutral.size()) * sizeof(double));
  add(data.uvs.data(), static_cast<std::size_t>(data.uvs.size()) * sizeof(double));
  for (const auto* list : {&data.face_offsets, &data.corner_vertex, &data.corner_uv})
    add(list->data(), list->size() * sizeof(int));
  return sha256_of_bytes(bytes);
}

}  // namespace vultus::apps
