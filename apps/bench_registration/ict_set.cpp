#include <algorithm>
#include <array>

#include "apps/bench_registration/case_set.h"
#include "apps/bench_registration/resample.h"
#include "core/error.h"
#include "core/files.h"
#include "core/random.h"
#include "rig/databank.h"

namespace vultus::apps::bench {
namespace {

/// A pose of the bench: files of the model that are added up.
struct IctPose {
  const char* name;
  std::vector<std::string> files;
};

// One or more of every part that moves: brows, lids, cheeks, nose, jaw, lips.
const std::vector<IctPose>& ict_poses() {
  static const std::vector<IctPose> poses = {{"neutral", {}},
                                             {"browDown", {"browDown_L", "browDown_R"}},
                                             {"browInnerUp", {"browInnerUp_L", "browInnerUp_R"}},
                                             {"eyeBlink", {"eyeBlink_L", "eyeBlink_R"}},
                                             {"cheekPuff", {"cheekPuff_L", "cheekPuff_R"}},
                                             {"noseSneer", {"noseSneer_L", "noseSneer_R"}},
                                             {"jawOpen", {"jawOpen"}},
                                             {"mouthSmile", {"mouthSmile_L", "mouthSmile_R"}},
                                             {"mouthPucker", {"mouthPucker"}},
                                             {"mouthFunnel", {"mouthFunnel"}},
                                             {"mouthLeft", {"mouthLeft"}},
                                             {"mouthStretch", {"mouthStretch_L", "mouthStretch_R"}},
                                             {"mouthRollLower", {"mouthRollLower"}}};
  return poses;
}

constexpr double sigma = 1.5;  // of the identity coefficients

class IctSet final : public CaseSet {
 public:
  IctSet(const std::string& name, const SetOptions& options, const std::vector<std::string>& poses)
      : name_(name), options_(options), poses_(poses), bank_(read_bank(options)) {
    measured_ = measured_vertices(*head().topology, head().neutral, "face_narrow");
    // What lies on the eye without being seen there: wet film, shadow and lashes of the model.
    visible_.assign(measured_.size(), true);
    for (const auto& [part, vertices] : head().topology->sets())
      if (part.starts_with("eye_blend") || part.starts_with("eye_occlusion") || part.starts_with("eyelashes"))
        for (const int v : vertices) visible_[v] = false;
  }

  std::string name() const override { return name_; }
  const registration::Template& head() const override { return bank_.head; }
  const std::vector<bool>& measured() const override { return measured_; }
  std::vector<std::string> people() const override {
    std::vector<std::string> names;
    for (int p = 0; p < options_.people; ++p) names.push_back("person " + std::to_string(p + 1));
    return names;
  }
  std::vector<std::string> poses() const override { return poses_; }

  ScanCase make(int person, const std::string& pose) const override {
    Mesh whole{head().topology, shape(person, pose), {}, {}};
    const SubMesh seen = sub_mesh(whole, visible_);
    std::vector<bool> marked(seen.parent_vertex.size());
    std::vector<int> face;
    for (std::size_t v = 0; v < marked.size(); ++v) {
      marked[v] = measured_[seen.parent_vertex[v]];
      if (marked[v]) face.push_back(static_cast<int>(v));
    }
    ResampleOptions resampling;
    resampling.seed = case_seed(person, pose);
    if (options_.triangles > 0) resampling.triangles = options_.triangles;
    ResampledScan scan = resample(seen.mesh, face, resampling);
    ScanCase result;
    result.scan = std::move(scan.mesh);
    Truth& truth = result.truth.emplace();
    truth.surface = seen.mesh;
    truth.surface.positions = transformed(scan.scan_from_surface, seen.mesh.positions);
    truth.triangles = marked_triangles(*truth.surface.topology, marked);
    truth.vertices = transformed(scan.scan_from_surface, whole.positions);
    return result;
  }

 private:
  static rig::Databank read_bank(const SetOptions& options) {
    if (options.data.empty()) throw InputError("the set needs ICT-FaceKit's folder: --data or VULTUS_DATA");
    return rig::read_ict_facekit(options.data / "ict-facekit");
  }

  std::uint64_t case_seed(int person, const std::string& pose) const {
    const auto& all = ict_poses();
    const auto at = std::find_if(all.begin(), all.end(), [&](const IctPose& p) { return p.name == pose; });
    return (options_.seed * 1000 + static_cast<std::uint64_t>(person)) * 100 +
           static_cast<std::uint64_t>(at - all.begin());
  }

  const Points& pose_positions(const std::string& name) const {
    for (const rig::Pose& pose : bank_.actor.poses)
      if (pose.name == name) return pose.positions;
    throw InputError(options_.data / "ict-facekit", "has no " + name + ".obj");
  }

  Points shape(int person, const std::string& pose) const {
    Random random(options_.seed * 1000 + static_cast<std::uint64_t>(person), 7);
    Points positions = head().neutral;
    for (const rig::Pose& mode : bank_.identities)
      positions += sigma * random.normal() * (mode.positions - head().neutral);
    for (const IctPose& known : ict_poses())
      if (known.name == pose)
        for (const std::string& file : known.files) positions += pose_positions(file) - head().neutral;
    return positions;
  }

  std::string name_;
  SetOptions options_;
  std::vector<std::string> poses_;
  rig::Databank bank_;
  std::vector<bool> measured_, visible_;
};

}  // namespace

std::unique_ptr<CaseSet> ict_set(SetOptions options) {
  if (options.people <= 0) options.people = 5;
  std::vector<std::string> poses;
  for (const IctPose& pose : ict_poses()) poses.emplace_back(pose.name);
  return std::make_unique<IctSet>("ict", options, poses);
}

std::unique_ptr<CaseSet> large_set(SetOptions options) {
  if (options.people <= 0) options.people = 2;
  if (options.triangles <= 0) options.triangles = 700'000;
  return std::make_unique<IctSet>("large", options, std::vector<std::string>{"neutral"});
}

}  // namespace vultus::apps::bench
