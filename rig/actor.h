#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/image.h"
#include "core/mesh.h"
#include "register/template.h"

namespace vultus::rig {

/// One pose of the database on the actor's topology.
struct Pose {
  std::string name;
  std::vector<std::string> tags;  ///< FACS / ARKit / viseme names
  Points positions;               ///< vertex_count×3, mm
};

/// A region's mask over the vertices. Masks are ≥ 0 and sum to one at every vertex.
struct Region {
  std::string name;
  Eigen::VectorXf vertex_mask;  ///< vertex_count
};

/// A captured actor: poses in one topology (the first is the neutral), regions, marker places. The in-memory form of
/// an actor folder (DESIGN §2).
struct Actor {
  std::string name;
  std::string template_name;  ///< template the poses were registered to
  std::shared_ptr<const Topology> topology;
  Points rest;                                  ///< vertex_count×3, the template's own shape on this topology, mm
  std::optional<registration::Ibug68> ibug68;   ///< 68-point scheme as vertices of this topology
  std::vector<Pose> poses;                      ///< poses[0] is "neutral"
  std::vector<Region> regions;                  ///< empty until segmented; one "whole" region then counts
  Image region_masks;                           ///< texture space, one channel a region, sums to 1 at every texel
  std::map<std::string, SurfacePoint> markers;  ///< marker label → place on the topology
  Image albedo;                                 ///< neutral's, linear RGB in texture space; may be empty

  const Points& neutral() const { return poses.front().positions; }
  std::vector<std::string> pose_names() const;
  /// Index of a pose; throws `InputError` with the nearest name.
  int pose_index(const std::string& name) const;
};

/// Reads an actor folder (rig/database.h writes it); every artefact is checked against its recorded hash. Throws
/// `InputError` that names each artefact which is missing, damaged or edited by hand.
Actor load_actor(const std::filesystem::path& folder);

}  // namespace vultus::rig
