#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "core/mesh.h"
#include "mocap/gap_methods.h"

namespace vultus::mocap {

/// How far off a filling method is on this very take, learned by hiding samples that are known: for each of several gap
/// lengths, gaps are cut at random places into one marker and up to five of its neighbours, filled, and compared.
class GapErrors {
 public:
  using Method = std::function<std::optional<Guess>(const TakeView&, const Gap&)>;

  /// Tries lengths up to `longest` frames, each `growth` times the one before, that stand next to the length of one of
  /// `gaps`; `trials` gaps for each length and kind (inside the take, at an edge).
  GapErrors(const Take& take, const RigidGroups& groups, const std::vector<Gap>& gaps, const Method& method,
            int longest, int trials, int growth, std::uint64_t seed);

  /// Error in mm that 70 % of the samples at `frame` of such a gap stay below, given the method's own `scale` there and
  /// how many neighbours are missing too; grows with the length beyond the longest gap that could be tried. Infinite
  /// when nothing could be tried.
  double expected(const Take& take, const Gap& gap, int frame, double scale) const;

  /// The same averaged over places of a gap inside the take, for the scale that the trials had: to compare methods.
  double typical(int length) const;

 private:
  static constexpr int kPlaces = 4;  ///< from the gap's end to its middle
  struct Row {
    int length;
    double error[kPlaces];  ///< per unit of scale
    double typical;         ///< mm
  };
  static double interpolated(const std::vector<Row>& rows, int length, const std::function<double(const Row&)>& value);
  struct Trials;
  void learn(const Trials& trials, int length, bool edge, std::vector<std::vector<double>>& by_marker,
             std::vector<std::vector<double>>& by_crowd);
  int crowd_class(const Take& take, const Gap& gap) const;

  const RigidGroups& groups_;
  std::vector<Row> inside_, edge_;
  std::vector<double> marker_factor_, crowd_factor_;
};

}  // namespace vultus::mocap
