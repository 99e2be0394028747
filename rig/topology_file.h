#pragma once

#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "core/mesh.h"
#include "register/template.h"

namespace vultus::rig {

/// The names of a topology in the form of template.json (DESIGN §2): units, landmarks by name and by the 68-point
/// scheme, vertex sets. `name` is the template's.
nlohmann::json names_json(const Topology& topology, const std::optional<registration::Ibug68>& ibug68,
                          const std::string& name);

/// A topology as an actor folder keeps it: `topology.obj` beside `topology.json`.
struct StoredTopology {
  std::shared_ptr<const Topology> topology;  ///< with sets and landmarks
  Points rest;                               ///< vertex_count×3, mm
  std::optional<registration::Ibug68> ibug68;
  std::string template_name;
};
/// Throws `InputError` for units other than mm and for indices beyond the mesh.
StoredTopology read_topology(const std::filesystem::path& obj, const std::filesystem::path& json);

}  // namespace vultus::rig
