#include "apps/transferred_poses.h"

#include <oneapi/tbb/parallel_for.h>

#include <cstdio>

#include "core/files.h"
#include "core/mesh_io.h"
#include "rig/motion_transfer.h"
#include "rig/pending_files.h"
#include "rig/topology_file.h"

namespace vultus::apps {
namespace {

namespace fs = std::filesystem;

std::string pose_file(const std::string& pose) { return "poses/" + pose + ".ply"; }
std::string report_file(const std::string& pose) { return "report/" + pose + ".json"; }

Provenance provenance_of(const std::string& pose, const fs::path& databank, const std::string& method,
                         const Manifest& actor) {
  const Manifest source = Manifest::open(databank / "actor.json", "actor");
  Provenance provenance{"onboard", {{"transfer", method}}, {}};
  for (const std::string& artefact : {pose_file(pose), pose_file("neutral"), std::string("topology.obj")}) {
    provenance.inputs["databank " + artefact] = source.hash(artefact);
  }
  for (const std::string& artefact : {pose_file("neutral"), std::string("topology.obj")}) {
    provenance.inputs["actor " + artefact] = actor.hash(artefact);
  }
  return provenance;
}

rig::TransferFace face_of(const Manifest& actor) {
  rig::StoredTopology stored =
      rig::read_topology(rig::current_path(actor, "topology.obj"), rig::current_path(actor, "topology.json"));
  return {stored.topology, read_mesh(rig::current_path(actor, pose_file("neutral"))).positions, stored.ibug68};
}

struct Work {
  const rig::Pose* pose;
  Provenance provenance;
};

void write(const Work& work, const Points& positions, const std::string& decision, rig::ActorWriter& writer) {
  const std::string& name = work.pose->name;
  write_json(writer.folder() / report_file(name),
             {{"pose", name}, {"source", "transfer"}, {"verdict", "pass"}, {"reason", ""}, {"decisions", {decision}}});
  writer.manifest().record(report_file(name), work.provenance);
  writer.write_pose({name, work.pose->tags, positions}, work.provenance);
}

std::string decision_of(const rig::MotionTransfer& transfer) {
  char text[160];
  std::snprintf(text, sizeof text,
                "motion from a databank of %s topology, scaled by %.3f; %.1f %% of the vertices found it",
                transfer.same_topology() ? "the same" : "another", transfer.scale(), 100.0 * transfer.found_share());
  return text;
}

}  // namespace

TransferredPoses transfer_poses(const rig::Actor& databank, const fs::path& folder,
                                const std::vector<std::string>& poses, const std::string& method,
                                rig::ActorWriter& writer, Progress& progress) {
  TransferredPoses result;
  std::vector<Work> stale;
  for (const std::string& name : poses) {
    Work work{&databank.poses[static_cast<std::size_t>(databank.pose_index(name))],
              provenance_of(name, folder, method, writer.manifest())};
    const bool current = writer.pose_is_current(name, work.provenance) &&
                         writer.manifest().is_current(report_file(name), work.provenance);
    if (current)
      ++result.reused;
    else
      stale.push_back(std::move(work));
  }
  if (stale.empty()) return result;

  progress.begin("bringing expressions from the databank", stale.size());
  const rig::MotionTransfer transfer({databank.topology, databank.neutral(), databank.ibug68},
                                     face_of(writer.manifest()), {.method = rig::transfer_method_named(method)});
  const std::string decision = decision_of(transfer);
  progress.note(decision);
  result.decisions.push_back(decision);
  constexpr std::size_t batch = 8;  // so that a run cut short keeps most of its work
  for (std::size_t first = 0; first < stale.size(); first += batch) {
    progress.check();
    std::vector<Points> moved(std::min(batch, stale.size() - first));
    tbb::parallel_for(std::size_t{0}, moved.size(),
                      [&](std::size_t k) { moved[k] = transfer(stale[first + k].pose->positions); });
    for (std::size_t k = 0; k < moved.size(); ++k) write(stale[first + k], moved[k], decision, writer);
    progress.advance(moved.size());
    result.transferred += static_cast<int>(moved.size());
  }
  return result;
}

}  // namespace vultus::apps
