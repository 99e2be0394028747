#include <ceres/ceres.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "core/error.h"
#include "register/energy_solvers.h"

namespace vultus::registration {
namespace {

using Edge = RegistrationEnergy::Edge;
using Residual = RegistrationEnergy::Residual;

/// Where the control points of one evaluation take the vertices; terms share it.
class Shape : public ceres::EvaluationCallback {
 public:
  Shape(const RegistrationEnergy& energy, const Points& control) : energy_(energy), control_(control) {
    distances.resize(energy.vertices().size());
  }

  void PrepareForEvaluation(bool with_derivatives, bool new_place) override {
    if (!new_place && (has_derivatives_ || !with_derivatives)) return;
    if (with_derivatives)
      moved = energy_.bones().derivatives(control_, energy_.vertices());
    else
      moved.positions = energy_.bones()(control_, energy_.vertices());
    has_derivatives_ = with_derivatives;
    const std::vector<int>& slots = energy_.with_data();
    tbb::parallel_for(std::size_t{0}, slots.size(),
                      [&](std::size_t i) { distances[slots[i]] = energy_.distance_of(moved.positions.row(slots[i])); });
  }

  PlanarBones::Derivatives moved;
  std::vector<Residual> distances;  // by slot

 private:
  const RegistrationEnergy& energy_;
  const Points& control_;
  bool has_derivatives_ = false;
};

/// One residual over one to four vertices and all control points that move them.
template <typename Value>
class Term : public ceres::CostFunction {
 public:
  Term(const Shape& shape, const std::array<int, 4>& slots, const std::vector<int>& controls, Value value)
      : shape_(shape), slots_(slots), controls_(controls), value_(std::move(value)) {
    set_num_residuals(1);
    mutable_parameter_block_sizes()->assign(controls.size(), 3);
  }

  bool Evaluate(double const* const*, double* residuals, double** jacobians) const override {
    const Residual residual = value_();
    residuals[0] = residual.value;
    if (!jacobians) return std::isfinite(residual.value);
    for (std::size_t k = 0; k < controls_.size(); ++k)
      if (jacobians[k]) std::fill_n(jacobians[k], 3, 0.0);
    for (int corner = 0; corner < 4 && slots_[corner] >= 0; ++corner) {
      const int slot = slots_[corner];
      for (int i = shape_.moved.offsets[slot]; i < shape_.moved.offsets[slot + 1]; ++i) {
        const auto& entry = shape_.moved.entries[i];
        const auto k = std::lower_bound(controls_.begin(), controls_.end(), entry.control) - controls_.begin();
        if (!jacobians[k]) continue;
        Eigen::Map<Eigen::RowVector3d>(jacobians[k]) += residual.by_slot.col(corner).transpose() * entry.matrix;
      }
    }
    return std::isfinite(residual.value);
  }

 private:
  const Shape& shape_;
  std::array<int, 4> slots_;
  std::vector<int> controls_;
  Value value_;
};

// share · soft|r| as a loss of r²: Ceres halves it.
ceres::LossFunction* soft_loss(double share, double softness) {
  return new ceres::ScaledLoss(new ceres::SoftLOneLoss(softness), share / softness, ceres::TAKE_OWNERSHIP);
}

/// Builds the problem of one round.
class Builder {
 public:
  Builder(const RegistrationEnergy& energy, Shape& shape, Points& control)
      : energy_(energy), shape_(shape), control_(control), problem(options_for(shape)) {}

  void add_all() {
    ceres::LossFunction* distance = soft_loss(energy_.distance_share(), energy_.softness());
    for (int s : energy_.with_data()) add({s, -1, -1, -1}, distance, [this, s] { return shape_.distances[s]; });
    if (energy_.with_data().empty()) delete distance;
    if (energy_.edges().empty()) return;
    ceres::LossFunction* strain = soft_loss(energy_.strain_share(), energy_.softness());
    ceres::LossFunction* bending = soft_loss(std::max(1e-300, energy_.bending_share()), energy_.bending_softness());
    bool bent = false;
    for (const Edge& edge : energy_.edges()) {
      add({edge.a, edge.b, -1, -1}, strain,
          [this, &edge] { return RegistrationEnergy::strain_of(edge, shape_.moved.positions); });
      if (edge.d < 0) continue;
      bent = true;
      add({edge.a, edge.b, edge.c, edge.d}, bending,
          [this, &edge] { return RegistrationEnergy::bending_of(edge, shape_.moved.positions); });
    }
    if (!bent) delete bending;
  }

 private:
  static ceres::Problem::Options options_for(Shape& shape) {
    ceres::Problem::Options options;
    options.evaluation_callback = &shape;
    return options;
  }

  template <typename Value>
  void add(const std::array<int, 4>& slots, ceres::LossFunction* loss, Value value) {
    std::vector<int> controls;
    for (int s : slots)
      if (s >= 0)
        for (int c : energy_.bones().controls_of(energy_.vertices()[s])) controls.push_back(c);
    std::sort(controls.begin(), controls.end());
    controls.erase(std::unique(controls.begin(), controls.end()), controls.end());
    std::vector<double*> blocks;
    for (int c : controls) blocks.push_back(control_.row(c).data());
    problem.AddResidualBlock(new Term<Value>(shape_, slots, controls, std::move(value)), loss, blocks);
  }

  const RegistrationEnergy& energy_;
  Shape& shape_;
  Points& control_;

 public:
  ceres::Problem problem;
};

}  // namespace

SolvedEnergy solve_by_ceres(const RegistrationEnergy& energy, const Points& start,
                            const EnergyRegistrationOptions& options, Progress& progress) {
  if (!(energy.softness() > 0.0)) throw InputError("energy registration: Ceres needs a softness above 0");
  progress.check();
  SolvedEnergy solved{start};
  Shape shape(energy, solved.control);
  Builder builder(energy, shape, solved.control);
  builder.add_all();
  if (builder.problem.NumResidualBlocks() == 0) return solved;
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  solver.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;  // one thread, one order of summation
  solver.num_threads = 1;
  solver.max_num_iterations = options.most_steps;
  solver.function_tolerance = options.tolerance;
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &builder.problem, &summary);
  solved.steps = static_cast<int>(summary.iterations.size());
  solved.evaluations = summary.num_residual_evaluations;
  solved.converged = summary.termination_type == ceres::CONVERGENCE;
  return solved;
}

}  // namespace vultus::registration
