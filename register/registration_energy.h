#pragma once

#include <Eigen/Core>
#include <vector>

#include "register/planar_bones.h"
#include "register/scan_surface.h"

namespace vultus::registration {

/// Coefficients α, β, γ of eq. 17. The paper names none; these balance the terms on heads.
struct EnergyWeights {
  double distance = 1.0;  ///< ≥ 0, of a mean distance in mm
  double strain = 3.0;    ///< ≥ 0, of a mean change of length in mm, for edges of 1 mm on average (see below)
  double bending = 30.0;  ///< ≥ 0, mm: of a mean change of the cosine between neighbouring triangles
};

struct EnergyOptions {
  EnergyWeights weights;
  /// ≥ 0: |x| counts as sqrt(x² + s²) − s, so that derivatives exist; mm, for cosines a hundredth of it. 0 is the
  /// paper's own, fit for the simplex only.
  double softness = 0.1;
  int most_vertices = 3500;   ///< ≥ 1: means run over at most this many vertices …
  int most_edges = 3500;      ///< … and this many edges, taken at even intervals
  double least_cosine = 0.5;  ///< between mesh and scan where a vertex is to have data
  void validate() const;      ///< throws `InputError`
};

/// The terms of eq. 17 before their weights, and their weighted sum.
struct EnergyTerms {
  double distance = 0.0;  ///< mean over vertices with data, mm
  double strain = 0.0;    ///< mean over edges, mm
  double bending = 0.0;   ///< mean over edges with two triangles
  double total = 0.0;
};

/// Energy of Sánchez et al. 2003, eqs. 17 and 18, as a function of the control points that move the mesh by planar
/// bones: distance of vertices from the scan, change of edge lengths and of the cosine between the triangles at an
/// edge, against the `reference` shape.
///
/// Lengths in mm count more the coarser a mesh is; strain is therefore divided by the mean edge length (mm), so that
/// one weight serves all templates. A vertex has data where `find_data` saw a place of the scan facing it; the set
/// stays until asked again, so that the energy is one continuous function.
class RegistrationEnergy {
 public:
  /// `fitted` (vertex_count) names the skin that counts. All arguments but `options` must outlive this.
  RegistrationEnergy(const Topology& topology, const Points& reference, const PlanarBones& bones,
                     const std::vector<bool>& fitted, const ScanSurface& scan, const EnergyOptions& options = {});

  /// Decides which vertices have data: a place within `limit` mm of where `control` takes them. Returns how many.
  int find_data(const Points& control, double limit);

  EnergyTerms operator()(const Points& control) const;
  /// d total / d control (control_count×3).
  Points gradient(const Points& control) const;
  const PlanarBones& bones() const { return bones_; }
  const EnergyOptions& options() const { return options_; }

  /// @name What a solver sees of the terms. Slots number the vertices that take part.
  /// @{
  struct Edge {
    int a, b, c, d;       ///< slots: the edge, then the third corners of its triangles (−1 for one triangle)
    double length, bend;  ///< of the reference: mm; cosine
  };
  struct Residual {
    double value = 0.0;
    Eigen::Matrix<double, 3, 4> by_slot = Eigen::Matrix<double, 3, 4>::Zero();  ///< derivative by a, b, c, d
  };
  const std::vector<int>& vertices() const { return vertices_; }    ///< of each slot
  const std::vector<int>& with_data() const { return with_data_; }  ///< slots
  const std::vector<Edge>& edges() const { return edges_; }
  Residual distance_of(const Eigen::Vector3d& position) const;
  static Residual strain_of(const Edge& edge, const Points& slots);   ///< change of length, mm
  static Residual bending_of(const Edge& edge, const Points& slots);  ///< change of the cosine; 0 with one triangle
  /// What one residual's soft absolute value counts in the total.
  double distance_share() const;
  double strain_share() const;
  double bending_share() const;
  double softness() const { return options_.softness; }
  double bending_softness() const { return 0.01 * options_.softness; }
  /// @}

 private:
  const Topology& topology_;
  const PlanarBones& bones_;
  const ScanSurface& scan_;
  EnergyOptions options_;
  std::vector<int> vertices_;   // of each slot
  std::vector<int> sampled_;    // slots whose distance may count
  std::vector<int> with_data_;  // those that do now
  std::vector<Edge> edges_;
  int bent_ = 0;              // edges with two triangles
  double edge_length_ = 1.0;  // mean, mm
};

/// sqrt(x² + s²) − s, and its derivative.
double soft_absolute(double x, double softness);
double soft_absolute_slope(double x, double softness);

}  // namespace vultus::registration
