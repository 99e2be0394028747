#pragma once

#include <vector>

#include "core/mesh.h"

namespace vultus::registration {

/// Displacements (vertex_count×3) known at some vertices, carried smoothly to the others: each unknown one becomes the
/// mean of its neighbours, weighted by the inverse length of the edges (a discrete harmonic field). Vertices of
/// components without any known vertex keep the rows they came with.
Points fill_smoothly(const Topology& topology, const Points& positions, const Points& displacements,
                     const std::vector<bool>& known);

/// The same field with known vertices allowed to give way: minimizes Σ_known w |d − d_known|² + `stiffness` Σ_edges
/// |d_i − d_j|², edges counted by unit weight; `weights` are ≥ 0, 0 for unknown vertices.
Points fit_smoothly(const Topology& topology, const Points& displacements, const Eigen::VectorXd& weights,
                    double stiffness);

/// False for vertices that are not fitted to the scan: the sets whose names begin with eyeball, eye_socket, eye_blend,
/// eye_occlusion, eyelashes, lacrimal, inner_mouth, mouth_cavity, teeth, gums or tongue.
std::vector<bool> fitted_vertices(const Topology& topology);

/// The fitted vertices that a scanner could see: at least `least_open` of the half-space above them, weighted by the
/// cosine, is free. Insides of nostrils, lips, ears and lids fall out; what a scan shows there is another surface.
std::vector<bool> exposed_vertices(const Topology& topology, const Points& positions, double least_open = 0.2);

/// Moves each connected component without any fitted vertex (eyeballs, teeth) as one rigid body with the fitted
/// vertices around it: `rest` → `moved`, both vertex_count×3; `moved` is changed in place. With `scaling` free the body
/// may grow as its surroundings did.
void carry_components(const Topology& topology, const Points& rest, const std::vector<bool>& fitted, bool free_scale,
                      Points& moved);

}  // namespace vultus::registration
