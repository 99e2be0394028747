#include "apps/onboarding.h"

#include <algorithm>

#include "apps/actor_report.h"
#include "apps/capture.h"
#include "apps/command.h"
#include "apps/registration_report.h"
#include "apps/scanned_poses.h"
#include "apps/transferred_poses.h"
#include "core/error.h"
#include "core/files.h"
#include "register/template_file.h"
#include "register/template_head.h"
#include "rig/database.h"
#include "rig/region_masks.h"

namespace vultus::apps {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

registration::Template template_for(const OnboardOptions& options) {
  if (!options.template_path.empty()) return registration::read_template(options.template_path);
  if (!options.databank.empty() && fs::exists(options.databank / "template.json")) {
    return registration::read_template(options.databank);
  }
  return registration::template_head();
}

bool is_wanted(const std::string& pose, const OnboardOptions& options) {
  return pose == "neutral" || options.poses.empty() ||
         std::find(options.poses.begin(), options.poses.end(), pose) != options.poses.end();
}

class Onboarding {
 public:
  Onboarding(const OnboardOptions& options, Progress& progress)
      : options_(options),
        progress_(progress),
        capture_(read_capture(options.capture)),
        databank_(options.databank.empty() ? std::nullopt : std::optional(rig::load_actor(options.databank))),
        writer_(opened(options)) {}

  OnboardResult run() {
    check_wanted_poses();
    registration::RegisterOptions register_options =
        registration::register_options(options_.method, options_.energy_solver);
    register_options.landmarks_by = registration::landmark_finder_named(options_.landmarks_by);
    const registration::Registration registration(template_for(options_), register_options);
    const std::string template_hash = hash_of(registration.head());
    write_topology(registration, template_hash);

    std::vector<CapturedPose> scanned;
    for (const CapturedPose& pose : capture_.poses) {
      if (is_wanted(pose.name, options_)) scanned.push_back(pose);
    }
    const ScannedPoses scans =
        register_scans(capture_, scanned, registration, template_hash, method_in_words(register_options),
                       static_cast<std::uint64_t>(options_.memory_gb * 1e9), writer_, progress_);
    result_.registered = scans.registered;
    result_.reused = scans.reused;
    result_.failed = scans.failed;
    std::vector<std::string> kept;
    for (const CapturedPose& pose : scanned) {
      if (!has_failed(pose.name)) kept.push_back(pose.name);
    }
    if (databank_) transfer(kept);
    writer_.keep_poses(kept);
    find_regions();
    write_report(kept, registration.head().name);
    return std::move(result_);
  }

 private:
  static rig::ActorWriter opened(const OnboardOptions& options) {
    std::error_code ignored;
    if (options.force) fs::remove(options.actor / "actor.json", ignored);
    return rig::ActorWriter(options.actor);
  }

  void check_wanted_poses() const {
    std::vector<std::string> known;
    for (const CapturedPose& pose : capture_.poses) known.push_back(pose.name);
    if (databank_)
      for (const std::string& name : databank_->pose_names()) known.push_back(name);
    for (const std::string& name : options_.poses) check_name("pose", name, known);
  }

  void write_topology(const registration::Registration& registration, const std::string& template_hash) {
    const Provenance provenance{"onboard", json::object(), {{"template", template_hash}}};
    if (writer_.topology_is_current(provenance)) return;
    writer_.write_topology({registration.refined(), registration.refined_neutral(), {}, {}}, registration.head().name,
                           registration.head().ibug68, provenance);
  }

  bool has_failed(const std::string& pose) const {
    const auto names_it = [&](const std::string& line) { return line.starts_with(pose + ":"); };
    return std::any_of(result_.failed.begin(), result_.failed.end(), names_it);
  }

  void transfer(std::vector<std::string>& kept) {
    std::vector<std::string> wanted;
    for (const std::string& name : databank_->pose_names()) {
      const bool is_there = std::find(kept.begin(), kept.end(), name) != kept.end();
      if (!is_there && is_wanted(name, options_)) wanted.push_back(name);
    }
    const TransferredPoses transferred =
        transfer_poses(*databank_, options_.databank, wanted, options_.transfer, writer_, progress_);
    result_.transferred = transferred.transferred;
    decisions_ = transferred.decisions;
    result_.reused += transferred.reused;
    kept.insert(kept.end(), wanted.begin(), wanted.end());
  }

  void find_regions() {
    if (writer_.pose_names().size() < 2) {
      result_.warnings.push_back("one pose alone shows no motion: the face is not divided into regions");
      return;
    }
    Provenance provenance{"onboard", {{"regions", options_.regions}, {"seed", options_.seed}}, {}};
    for (const std::string& pose : writer_.pose_names()) {
      provenance.inputs[pose] = writer_.manifest().hash("poses/" + pose + ".ply");
    }
    if (writer_.regions_are_current(provenance)) return;
    progress_.begin("dividing the face into regions", 0);
    rig::Actor actor = rig::load_actor(options_.actor);
    rig::divide_face(actor, {.regions = options_.regions, .seed = options_.seed});
    writer_.write_regions(actor.regions, actor.region_masks, provenance);
  }

  void write_report(const std::vector<std::string>& kept, const std::string& template_name) {
    json poses = json::array();
    for (const std::string& pose : kept) {
      const std::string artefact = "report/" + pose + ".json";
      if (!writer_.manifest().has(artefact)) continue;
      poses.push_back(read_json(options_.actor / artefact));
      result_.below_quality = result_.below_quality || poses.back().value("verdict", "") == "fail";
    }
    for (const std::string& line : result_.failed) {
      const std::size_t name_end = line.find(": ");
      poses.push_back(unregistered_report(line.substr(0, name_end), line.substr(name_end + 2)));
    }
    json warnings = result_.warnings;
    result_.report = {{"template", template_name},
                      {"method", options_.method},
                      {"poses", poses},
                      {"decisions", decisions_},
                      {"warnings", warnings}};
    write_json(options_.actor / "report/registration.json", result_.report);
    write_file(options_.actor / "report/index.html",
               actor_report_page(writer_.manifest().facts().at("name"), result_.report));
    for (const char* file : {"report/registration.json", "report/index.html"})
      writer_.manifest().record(file, {"onboard", json::object(), {}});
    forget_other_reports(kept);
    writer_.manifest().save();
  }

  void forget_other_reports(const std::vector<std::string>& kept) {
    for (const std::string& artefact : writer_.manifest().artefacts()) {
      if (!artefact.starts_with("report/") || artefact == "report/registration.json" || artefact == "report/index.html")
        continue;
      const auto belongs = [&](const std::string& pose) { return is_report_of(pose, artefact); };
      if (std::none_of(kept.begin(), kept.end(), belongs)) writer_.manifest().forget(artefact);
    }
  }

  const OnboardOptions& options_;
  Progress& progress_;
  Capture capture_;
  std::optional<rig::Actor> databank_;
  rig::ActorWriter writer_;
  std::vector<std::string> decisions_;
  OnboardResult result_;
};

}  // namespace

OnboardResult onboard_actor(const OnboardOptions& options, Progress& progress) {
  return Onboarding(options, progress).run();
}

}  // namespace vultus::apps
