#include "register/template_file.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/files.h"
#include "core/mesh_io.h"
#include "scan/clean.h"

namespace vultus::registration {
namespace fs = std::filesystem;
using nlohmann::json;

namespace {

const std::string ibug_scheme = "ibug-68";

void check_keys(const fs::path& file, const json& object, const std::string& place,
                const std::vector<std::string>& known) {
  if (!object.is_object()) throw InputError(file, place, "must be a JSON object");
  for (const auto& [key, value] : object.items()) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    const std::string near = nearest_name(key, known);
    throw InputError(file, place,
                     "unknown entry \"" + key + "\"" + (near.empty() ? "" : "; did you mean \"" + near + "\"?"));
  }
}

int read_vertex(const fs::path& file, const std::string& place, const json& value, int least, int vertex_count) {
  if (!value.is_number_integer()) throw InputError(file, place, "must be a vertex number");
  const auto vertex = value.get<long long>();
  if (vertex < least || vertex >= vertex_count)
    throw InputError(file, place,
                     "vertex " + std::to_string(vertex) + " is not in the mesh of " + std::to_string(vertex_count) +
                         " vertices (numbers start at 0)");
  return static_cast<int>(vertex);
}

Ibug68 read_ibug(const fs::path& file, const json& landmarks, int vertex_count) {
  if (landmarks.value("scheme", ibug_scheme) != ibug_scheme)
    throw InputError(file, "landmarks.scheme", "must be \"" + ibug_scheme + "\"");
  const json& vertices = landmarks.at("vertices");
  Ibug68 ibug{};
  if (!vertices.is_array() || vertices.size() != ibug.size())
    throw InputError(file, "landmarks.vertices", "must be a list of 68 vertex numbers");
  for (std::size_t i = 0; i < ibug.size(); ++i)
    ibug[i] = read_vertex(file, "landmarks.vertices[" + std::to_string(i) + "]", vertices[i], -1, vertex_count);
  return ibug;
}

void read_landmarks(const fs::path& file, const json& landmarks, int vertex_count, Template& result) {
  check_keys(file, landmarks, "landmarks", {"scheme", "vertices", "points", "major"});
  if (landmarks.contains("vertices")) result.ibug68 = read_ibug(file, landmarks, vertex_count);
  if (landmarks.contains("points")) {
    const json& points = landmarks.at("points");
    if (!points.is_object()) throw InputError(file, "landmarks.points", "must map names to vertex numbers");
    for (const auto& [name, vertex] : points.items())
      result.landmarks.push_back({name, read_vertex(file, "landmarks.points." + name, vertex, 0, vertex_count), false});
  }
  if (!result.ibug68 && result.landmarks.empty())
    throw InputError(file, "landmarks", "needs \"vertices\" (68 numbers) or \"points\" (name: number)");
  const json major = landmarks.value("major", json::array());
  if (!major.is_array()) throw InputError(file, "landmarks.major", "must be a list of names from \"points\"");
  for (const json& name : major) {
    auto same = [&](const Landmark& l) { return name.is_string() && l.name == name.get<std::string>(); };
    const auto found = std::find_if(result.landmarks.begin(), result.landmarks.end(), same);
    if (found == result.landmarks.end())
      throw InputError(file, "landmarks.major", name.dump() + " is not among \"points\"");
    found->major = true;
  }
}

VertexSets read_sets(const fs::path& file, const json& sets, int vertex_count) {
  if (!sets.is_object()) throw InputError(file, "sets", "must map names to lists of vertex numbers");
  VertexSets result;
  for (const auto& [name, members] : sets.items()) {
    const std::string place = "sets." + name;
    if (!members.is_array()) throw InputError(file, place, "must be a list of vertex numbers");
    std::vector<int>& set = result[name];
    for (const json& vertex : members) set.push_back(read_vertex(file, place, vertex, 0, vertex_count));
    std::sort(set.begin(), set.end());
    set.erase(std::unique(set.begin(), set.end()), set.end());
  }
  return result;
}

struct TemplateFiles {
  fs::path obj, description;
};

TemplateFiles locate(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) return {path / "template.obj", path / "template.json"};
  if (path.extension() == ".json") return {fs::path(path).replace_extension(".obj"), path};
  return {path, fs::path(path).replace_extension(".json")};
}

Template describe(const fs::path& file, const json& description, const Mesh& mesh) {
  check_keys(file, description, "top level",
             {"name", "units", "landmarks", "sets", "subdivisions", "source", "licence", "license", "comment"});
  if (!description.contains("units") || !description.at("units").is_string())
    throw InputError(file, "units", "is missing; write \"mm\", \"cm\", \"m\" or \"in\"");
  if (!description.contains("landmarks")) throw InputError(file, "landmarks", "is missing");

  Template result;
  const int vertex_count = mesh.topology->vertex_count();
  double scale = 1.0;
  try {
    scale = millimetres(description.at("units").get<std::string>());
  } catch (const InputError& problem) {
    throw InputError(file, "units", problem.what());
  }
  result.neutral = scale * mesh.positions;
  if (description.contains("name") && !description.at("name").is_string())
    throw InputError(file, "name", "must be a text");
  result.name = description.value("name", file.parent_path().filename().string());
  read_landmarks(file, description.at("landmarks"), vertex_count, result);
  const json levels = description.value("subdivisions", json(0));
  if (!levels.is_number_integer() || levels.get<long long>() < 0 || levels.get<long long>() > 4)
    throw InputError(file, "subdivisions", "must be a whole number from 0 to 4");
  result.subdivisions = levels.get<int>();

  TopologyData data = mesh.topology->data();
  data.sets = read_sets(file, description.value("sets", json::object()), vertex_count);
  for (const Landmark& landmark : result.landmarks) data.landmarks[landmark.name] = landmark.vertex;
  result.topology = Topology::make(std::move(data));
  return result;
}

}  // namespace

double millimetres(const std::string& unit) {
  static const std::map<std::string, double> known = {{"mm", 1.0}, {"cm", 10.0}, {"m", 1000.0}, {"in", 25.4}};
  const auto found = known.find(unit);
  if (found == known.end()) throw InputError("unknown unit \"" + unit + "\"; use mm, cm, m or in");
  return found->second;
}

Template read_template(const fs::path& path) {
  const TemplateFiles files = locate(path);
  const Mesh mesh = read_mesh(files.obj);
  if (mesh.topology->face_count() == 0)
    throw InputError(files.obj, "a template needs faces, this file has points only");
  std::error_code ignored;
  if (fs::exists(files.description, ignored)) return describe(files.description, read_json(files.description), mesh);
  Template result;
  result.name = files.obj.stem().string();
  result.topology = mesh.topology;
  result.neutral = scan::guess_units(mesh.positions).mm_per_unit * mesh.positions;
  return result;
}

void write_template(const fs::path& folder, const Template& value) {
  json landmarks = json::object();
  if (value.ibug68) {
    landmarks["scheme"] = ibug_scheme;
    landmarks["vertices"] = *value.ibug68;
  }
  json major = json::array();
  for (const Landmark& landmark : value.landmarks) {
    landmarks["points"][landmark.name] = landmark.vertex;
    if (landmark.major) major.push_back(landmark.name);
  }
  if (!major.empty()) landmarks["major"] = major;
  json description = {{"name", value.name}, {"units", "mm"}, {"landmarks", landmarks}};
  description["subdivisions"] = value.subdivisions;
  description["sets"] = json::object();
  for (const auto& [name, vertices] : value.topology->sets()) description["sets"][name] = vertices;

  Mesh mesh;
  mesh.topology = value.topology;
  mesh.positions = value.neutral;
  write_obj(folder / "template.obj", mesh);
  write_json(folder / "template.json", description);
}

}  // namespace vultus::registration
