#include <CLI/CLI.hpp>
#include <algorithm>
#include <sstream>

#include "apps/commands.h"
#include "core/array_io.h"
#include "core/files.h"
#include "core/image.h"
#include "core/manifest.h"
#include "core/mesh_io.h"
#include "mocap/take.h"

namespace vultus::apps {
namespace {

namespace fs = std::filesystem;

std::string lower_extension(const fs::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return extension;
}

nlohmann::json mesh_facts(const fs::path& file) {
  const Mesh mesh = read_mesh(file, NonFinite::keep);
  nlohmann::json facts = {{"kind", "mesh"},
                          {"vertices", mesh.positions.rows()},
                          {"faces", mesh.topology->face_count()},
                          {"triangles", mesh.topology->triangles().rows()},
                          {"uvs", mesh.topology->has_uvs()},
                          {"colours", mesh.has_colours()}};
  const auto broken = (!mesh.positions.array().isFinite()).rowwise().any().count();
  facts["non_finite_vertices"] = broken;
  if (broken == 0) {
    const Eigen::Vector3d size = bounds(mesh.positions).max - bounds(mesh.positions).min;
    facts["size"] = {size.x(), size.y(), size.z()};
  }
  if (!mesh.texture.empty()) facts["texture"] = mesh.texture;
  return facts;
}

nlohmann::json take_facts(const fs::path& file) {
  const mocap::Take take = mocap::read_take(file);
  const auto missing = std::count(take.present.begin(), take.present.end(), 0);
  return {{"kind", "take"},         {"frames", take.frames()},    {"rate_hz", take.rate_hz},
          {"markers", take.labels}, {"missing_samples", missing}, {"decisions", take.decisions}};
}

nlohmann::json image_facts(const fs::path& file) {
  const Image image = read_image(file);
  return {{"kind", "image"}, {"width", image.width()}, {"height", image.height()}, {"channels", image.channel_names()}};
}

nlohmann::json manifest_facts(const fs::path& file) {
  const nlohmann::json content = read_json(file);
  if (!content.is_object() || !content.contains("kind") || !content.contains("artefacts")) {
    return {{"kind", "json"}, {"entries", content.size()}};
  }
  const Manifest manifest = Manifest::open(file, content.at("kind").get<std::string>());
  return {{"kind", content.at("kind")},
          {"version", content.value("version", "")},
          {"artefacts", manifest.artefacts().size()},
          {"damaged", manifest.damaged()},
          {"facts", manifest.facts()}};
}

// Every manifest in the folder itself; folders of ours have one, captures may have none.
nlohmann::json folder_facts(const fs::path& folder) {
  for (const char* name : {"actor.json", "session.json", "simulation.json", "capture.json"}) {
    if (fs::exists(folder / name)) return manifest_facts(folder / name);
  }
  std::vector<std::string> scans;
  if (fs::is_directory(folder / "scans")) {
    for (const auto& entry : fs::directory_iterator(folder / "scans"))
      scans.push_back(entry.path().filename().string());
  }
  if (scans.empty()) throw InputError(folder, "is no actor, session, simulation or capture folder");
  std::sort(scans.begin(), scans.end());
  return {{"kind", "capture"}, {"scans", scans}};
}

nlohmann::json facts_of(const fs::path& path) {
  if (fs::is_directory(path)) return folder_facts(path);
  const std::string extension = lower_extension(path);
  if (extension == ".obj" || extension == ".ply" || extension == ".stl") return mesh_facts(path);
  if (extension == ".c3d" || extension == ".trc" || extension == ".csv") return take_facts(path);
  if (extension == ".npy") return {{"kind", "array"}, {"shape", read_npy(path).shape}};
  if (extension == ".json") return manifest_facts(path);
  return image_facts(path);
}

ExitCode inspect(const fs::path& path, Run& run) {
  run.numbers() = facts_of(path);
  run.print(run.numbers().dump(1));
  const nlohmann::json damaged = run.numbers().value("damaged", nlohmann::json::array());
  if (damaged.empty()) return ExitCode::ok;
  std::string names;
  for (const std::string name : damaged) names += (names.empty() ? "" : ", ") + name;
  throw InputError(path, "damaged, missing or edited by hand: " + names);
}

}  // namespace

void add_inspect(CommandTable& table) {
  auto path = std::make_shared<fs::path>();
  CLI::App& app = table.add("inspect", "What a file or folder is, and whether it is sound",
                            "vultus inspect actor\n  vultus inspect takes/smile.c3d", {},
                            [path](Run& run) { return inspect(*path, run); });
  app.add_option("PATH", *path, "Mesh, take, image, array, manifest, or an actor, session or capture folder")
      ->required();
}

}  // namespace vultus::apps
