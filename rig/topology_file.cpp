#include "rig/topology_file.h"

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/files.h"
#include "core/mesh_io.h"

namespace vultus::rig {
using Json = nlohmann::json;

Json names_json(const Topology& topology, const std::optional<registration::Ibug68>& ibug68, const std::string& name) {
  Json landmarks = {{"points", topology.landmarks()}};
  if (ibug68) {
    landmarks["scheme"] = "ibug-68";
    landmarks["vertices"] = *ibug68;
  }
  return {{"name", name}, {"units", "mm"}, {"landmarks", landmarks}, {"sets", topology.sets()}};
}

StoredTopology read_topology(const std::filesystem::path& obj, const std::filesystem::path& json) {
  const Mesh mesh = read_mesh(obj);
  const Json names = read_json(json);
  StoredTopology stored;
  TopologyData data = mesh.topology->data();
  // Both files were checked against their hashes, so that what is wrong here was written wrong: no repair is tried.
  try {
    if (names.at("units") != "mm") throw InputError(json, "\"units\"", "expected \"mm\"");
    stored.template_name = names.at("name");
    data.sets = names.at("sets").get<VertexSets>();
    data.landmarks = names.at("landmarks").at("points").get<LandmarkVertices>();
    if (names.at("landmarks").contains("vertices"))
      stored.ibug68 = names.at("landmarks").at("vertices").get<registration::Ibug68>();
  } catch (const Json::exception& error) {
    throw InputError(json, std::string("does not hold the names of a topology: ") + error.what());
  }
  if (stored.ibug68)
    for (int vertex : *stored.ibug68)
      if (vertex < -1 || vertex >= data.vertex_count)
        throw InputError(json, "landmarks.vertices", "vertex " + std::to_string(vertex) + " is not in the mesh");
  stored.rest = mesh.positions;
  stored.topology = Topology::make(std::move(data));
  return stored;
}

}  // namespace vultus::rig
