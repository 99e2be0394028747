#include "rig/databank.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/files.h"
#include "core/mesh_io.h"
#include "core/transform.h"
#include "register/template_file.h"
#include "rig/databank_parts.h"
#include "rig/database.h"
#include "rig/pending_files.h"

namespace vultus::rig {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr const char* kNeutral = "generic_neutral_mesh";
constexpr int kForm = 2;                    // raised when the same folder gives another databank: sets, UVs, poses
constexpr double kOuterEyeDistance = 92.0;  // mm, adult mean (Farkas 1994: 87–97)

struct Index {
  std::vector<std::string> expressions;
  std::vector<int> rigid;
  registration::Ibug68 ibug68{};
};

Index read_index(const fs::path& file) {
  const Json json = read_json(file);
  Index index;
  try {
    index.expressions = json.at("expressions").get<std::vector<std::string>>();
    index.rigid = json.at("idx_to_rigid_verts").get<std::vector<int>>();
    index.ibug68 = json.at("idx_to_landmark_verts").get<registration::Ibug68>();
  } catch (const Json::exception& error) {
    throw InputError(file, std::string("expected \"expressions\", \"idx_to_rigid_verts\" and 68 ") +
                               "\"idx_to_landmark_verts\": " + error.what());
  }
  for (const std::vector<int>& list : {index.rigid, std::vector<int>(index.ibug68.begin(), index.ibug68.end())})
    for (int vertex : list)
      if (vertex < 0 || vertex >= ict_vertex_count)
        throw InputError(file, "vertex " + std::to_string(vertex) + " is not in the model");
  return index;
}

Mesh read_model_mesh(const fs::path& file) {
  Mesh mesh = read_mesh(file);
  if (mesh.topology->vertex_count() != ict_vertex_count)
    throw InputError(file, fmt::format("has {} vertices; ICT-FaceKit's light model has {}",
                                       mesh.topology->vertex_count(), ict_vertex_count));
  return mesh;
}

/// Vultus' frame from the model's: the unit that brings the outer eye corners nearest to an adult's, the origin
/// midway between them. The axes must already agree.
Similarity face_from_model(const Points& neutral, const registration::Ibug68& ibug68, const fs::path& file,
                           std::vector<std::string>& decisions) {
  const Eigen::Vector3d right = neutral.row(ibug68[36]), left = neutral.row(ibug68[45]);
  const Eigen::Vector3d nose = neutral.row(ibug68[30]), chin = neutral.row(ibug68[8]);
  const Eigen::Vector3d across = left - right, middle = 0.5 * (left + right);
  if (across.x() < 0.95 * across.norm() || nose.z() <= middle.z() || chin.y() >= nose.y() || nose.y() >= middle.y())
    throw InputError(file, "the face must look along +z with +y up");
  const std::pair<const char*, double> units[] = {{"mm", 1.0}, {"cm", 10.0}, {"in", 25.4}, {"m", 1000.0}};
  const auto misfit = [&](double scale) { return std::abs(std::log(scale * across.norm() / kOuterEyeDistance)); };
  const auto* best = std::min_element(std::begin(units), std::end(units), [&](const auto& a, const auto& b) {
    return misfit(a.second) < misfit(b.second);
  });
  if (misfit(best->second) > std::log(1.5))
    throw InputError(
        file, fmt::format("outer eye corners are {:.3g} units apart, which is a head in no unit known", across.norm()));
  decisions.push_back(fmt::format("units: {}, since the outer eye corners are {:.4g} apart ({:.1f} mm)", best->first,
                                  across.norm(), best->second * across.norm()));
  Similarity frame;
  frame.scale = best->second;
  frame.translation = -best->second * middle;
  decisions.push_back(fmt::format("frame: origin moved by ({:.1f}, {:.1f}, {:.1f}) mm to midway between the eyes",
                                  frame.translation.x(), frame.translation.y(), frame.translation.z()));
  return frame;
}

struct Names {
  std::vector<std::string> expressions, identities;
};

Names files_present(const fs::path& folder, const Index& index, std::vector<std::string>& decisions) {
  Names names;
  std::string missing, unlisted;
  for (const std::string& name : index.expressions) {
    if (fs::exists(folder / (name + ".obj")))
      names.expressions.push_back(name);
    else
      missing += " " + name;
  }
  std::vector<std::string> others;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string stem = entry.path().stem().string();
    if (entry.path().extension() != ".obj" || stem == kNeutral) continue;
    if (stem.starts_with("identity"))
      names.identities.push_back(stem);
    else if (std::find(index.expressions.begin(), index.expressions.end(), stem) == index.expressions.end())
      others.push_back(stem);
  }
  std::sort(others.begin(), others.end());
  std::sort(names.identities.begin(), names.identities.end());
  for (const std::string& name : others) {
    names.expressions.push_back(name);
    unlisted += " " + name;
  }
  if (!missing.empty()) decisions.push_back("listed but absent, left out:" + missing);
  if (!unlisted.empty()) decisions.push_back("present but not listed, taken too:" + unlisted);
  return names;
}

std::vector<Pose> read_poses(const fs::path& folder, const std::vector<std::string>& names, const Similarity& frame,
                             Progress& progress) {
  std::vector<Pose> poses(names.size());
  tbb::parallel_for(std::size_t{0}, names.size(), [&](std::size_t i) {
    progress.check();
    poses[i] = {names[i], ict_pose_tags(names[i]),
                transformed(frame, read_model_mesh(folder / (names[i] + ".obj")).positions)};
    progress.advance();
  });
  return poses;
}

void complete_correctives(Actor& actor, std::vector<std::string>& decisions) {
  Pose *open = nullptr, *close = nullptr;
  for (Pose& pose : actor.poses) {
    if (pose.name == "jawOpen") open = &pose;
    if (pose.name == "mouthClose") close = &pose;
  }
  if (open == nullptr || close == nullptr) return;
  close->positions += open->positions - actor.neutral();
  close->tags.push_back("jawOpen");
  decisions.push_back("mouthClose corrects jawOpen: kept as jawOpen + mouthClose, an open jaw with closed lips");
}

registration::Template model_template(const Mesh& neutral, const Index& index, const Similarity& frame) {
  registration::Template head;
  head.name = "ict-facekit";
  head.neutral = transformed(frame, neutral.positions);
  head.ibug68 = index.ibug68;
  head.landmarks = mpeg4_landmarks(index.ibug68);
  TopologyData data = neutral.topology->data();
  data.sets = ict_vertex_sets(*neutral.topology, head.neutral, index.ibug68, index.rigid);
  for (const registration::Landmark& landmark : head.landmarks) data.landmarks[landmark.name] = landmark.vertex;
  if (!data.corner_uv.empty()) lay_out_ict_uvs(data);
  head.topology = Topology::make(std::move(data));
  return head;
}

Provenance provenance_of(const fs::path& folder) {
  std::map<std::string, std::string> inputs;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string extension = entry.path().extension().string();
    if (extension == ".obj" || extension == ".json")
      inputs[entry.path().filename().string()] = sha256_of_file(entry.path());
  }
  return {"rig databank", {{"source", "ict-facekit"}, {"form", kForm}}, inputs};
}

bool all_current(const Manifest& manifest, const Provenance& provenance) {
  const std::vector<std::string> artefacts = manifest.artefacts();
  return manifest.has("template.obj") && std::all_of(artefacts.begin(), artefacts.end(), [&](const std::string& name) {
           return manifest.is_current(name, provenance);
         });
}

}  // namespace

Databank read_ict_facekit(const fs::path& folder, Progress& progress) {
  if (!fs::is_directory(folder)) throw InputError(folder, "is no folder");
  const Index index = read_index(folder / "vertex_indices.json");
  const fs::path neutral_file = folder / (std::string(kNeutral) + ".obj");
  const Mesh neutral = read_model_mesh(neutral_file);
  Databank bank;
  const Similarity frame = face_from_model(neutral.positions, index.ibug68, neutral_file, bank.decisions);
  const Names names = files_present(folder, index, bank.decisions);
  bank.head = model_template(neutral, index, frame);

  progress.begin("reading the databank", names.expressions.size() + names.identities.size());
  bank.actor.name = bank.actor.template_name = bank.head.name;
  bank.actor.topology = bank.head.topology;
  bank.actor.rest = bank.head.neutral;
  bank.actor.ibug68 = index.ibug68;
  bank.actor.poses = read_poses(folder, names.expressions, frame, progress);
  bank.actor.poses.insert(bank.actor.poses.begin(), Pose{"neutral", {}, bank.head.neutral});
  bank.identities = read_poses(folder, names.identities, frame, progress);
  complete_correctives(bank.actor, bank.decisions);
  for (const std::string& decision : bank.decisions) progress.note(decision);
  return bank;
}

std::vector<std::string> import_ict_facekit(const fs::path& ict_folder, const fs::path& out, Progress& progress,
                                            bool force) {
  if (!fs::is_directory(ict_folder)) throw InputError(ict_folder, "is no folder");
  const Provenance provenance = provenance_of(ict_folder);
  if (!force && all_current(Manifest::open(out / "actor.json", "actor"), provenance)) return {"everything is current"};
  const Databank bank = read_ict_facekit(ict_folder, progress);
  save_actor(out, bank.actor, provenance);
  ActorWriter writer(out);
  std::vector<PendingFile> files;
  for (const Pose& identity : bank.identities)
    files.emplace_back("identities/" + identity.name + ".ply", [&bank, &identity](const fs::path& file) {
      write_ply(file, {bank.actor.topology, identity.positions, {}, {}});
    });
  commit_files(writer.manifest(), files, provenance);
  registration::write_template(out, bank.head);
  // The mark of a finished import: recorded last.
  writer.manifest().record("template.json", provenance);
  writer.manifest().record("template.obj", provenance);
  writer.manifest().save();
  return bank.decisions;
}

std::vector<Pose> load_identities(const fs::path& databank_folder) {
  const Manifest manifest = Manifest::open(databank_folder / "actor.json", "actor");
  std::vector<Pose> identities;
  for (const std::string& artefact : manifest.artefacts())
    if (artefact.starts_with("identities/"))
      identities.push_back(
          {fs::path(artefact).stem().string(), {}, read_mesh(current_path(manifest, artefact)).positions});
  return identities;
}

}  // namespace vultus::rig
