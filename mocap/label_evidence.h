#pragma once

#include <memory>
#include <vector>

#include "mocap/marker_model.h"
#include "mocap/take.h"
#include "mocap/tracklets.h"

namespace vultus::mocap {

/// What is shorter is left to `find_spikes`.
constexpr double kSpikeSeconds = 0.02;

/// A tracklet and the label it bears for now.
struct LabelledTracklet {
  Tracklet span;         ///< `column` counts in the raw take
  int label = -1;        ///< number of a label, -1: none
  bool trusted = false;  ///< fits its label, or hangs together with what does
  double misfit = 0.0;   ///< under its label, mm; infinite without one
};

/// What speaks for and against a label of a tracklet: where the neighbours put the marker, and where it was just before
/// and after. All in head coordinates from the take's steadiest markers, so that neither the jig nor a part of the face
/// is trusted alone.
class LabelEvidence {
 public:
  /// Cuts the take into tracklets; learns where markers are. `jump_mm` as in `cut_tracklets`. Throws `InputError` for
  /// takes without six markers that are seen in half of the frames.
  LabelEvidence(const Take& raw, double jump_mm);

  int labels() const { return static_cast<int>(label_columns_.size()); }
  const std::string& name(int label) const { return raw_.labels[static_cast<std::size_t>(column(label))]; }
  int column(int label) const { return label_columns_[static_cast<std::size_t>(label)]; }
  const std::string& column_name(int c) const { return raw_.labels[static_cast<std::size_t>(c)]; }
  double rate_hz() const { return raw_.rate_hz; }
  /// `MarkerModel::scatter`.
  double scatter(int label) const { return model_->scatter(label); }

  std::vector<LabelledTracklet>& tracklets() { return tracklets_; }
  const std::vector<LabelledTracklet>& tracklets() const { return tracklets_; }
  /// To be called when labels or trust of the tracklets have changed.
  void refresh();

  /// How far the tracklet is from where the neighbours put the marker `label`, mm: the median over some of its frames.
  double misfit(const Tracklet& t, int label) const;
  /// The same, allowing for the misfit that the marker itself shows just before and after, where that is trusted.
  double informed_misfit(const Tracklet& t, int label) const;
  /// The least of the misfits at the two ends, each against the trusted stretch of `label` beside it at most a quarter
  /// of a second away: small when the tracklet continues what was before or leads to what comes after. Infinite
  /// without.
  double end_misfit(const Tracklet& t, int label) const;
  /// Where the tracklet is in head coordinates, at its first or last frame or another that is looked at; NaN where the
  /// head was not found.
  Eigen::Vector3d place(const Tracklet& t, int frame) const;
  /// Whether the label's usual place is so near that it comes into question.
  bool is_near(const Tracklet& t, int label) const;

 private:
  struct Beside {
    int frame = -1;  // -1: none
    Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  };
  std::vector<int> looked_at(const Tracklet& t) const;
  void to_head_coordinates();
  int row(int frame) const { return row_of_[static_cast<std::size_t>(frame)]; }
  Beside trusted_beside(const Tracklet& t, int label, int side) const;

  const Take& raw_;
  std::vector<int> label_columns_, label_of_column_;
  std::vector<LabelledTracklet> tracklets_;
  std::vector<int> row_of_;  // of each raw frame in `head_` and `current_`; -1 where it is not looked at
  Take head_;                // raw columns, head coordinates, the frames that are looked at
  Take current_;             // the same under the labels as they are now
  std::unique_ptr<MarkerModel> model_;
  std::vector<std::vector<int>> by_label_;  // trusted tracklets in order of frames
};

}  // namespace vultus::mocap
