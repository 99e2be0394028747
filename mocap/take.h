#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/mesh.h"

namespace vultus::mocap {

/// How a sample of a cleaned take came to be. A measured one that was under a wrong label, or that smoothing moved, is
/// still measured.
enum class Origin : std::uint8_t { measured, missing, spline, rigid_group, local_frame, low_rank };

/// A named moment of a take.
struct Event {
  std::string label;
  double time_s = 0.0;  ///< from the start of the recording (the file's own clock)
};

/// Marker trajectories. Frames count from 0. A missing sample has `present == 0`; its position is then meaningless.
struct Take {
  std::string name;
  double rate_hz = 0.0;
  std::vector<std::string> labels;    ///< marker names, unique
  std::vector<float> positions;       ///< frames × markers × 3, mm, +y up
  std::vector<std::uint8_t> present;  ///< frames × markers
  std::vector<float> residuals;       ///< frames × markers, mm; empty when the file has none
  std::vector<std::uint8_t> cameras;  ///< frames × markers, bit i: seen by camera i+1; empty when the file has none
  float residual_step = 0.0F;         ///< mm per unit of a C3D residual; 0 when the file has none
  int first_frame = 1;                ///< the file's own number of frame 0
  std::vector<int> file_frames;       ///< frames: each one's number in the file, from 0, rising; empty: the same
  std::vector<Event> events;
  std::vector<std::string> decisions;  ///< what reading decided (units, axes), for the report

  int markers() const { return static_cast<int>(labels.size()); }
  int frames() const { return labels.empty() ? 0 : static_cast<int>(present.size() / labels.size()); }
  std::size_t index(int frame, int marker) const { return static_cast<std::size_t>(frame) * labels.size() + marker; }
  bool has(int frame, int marker) const { return present[index(frame, marker)] != 0; }
  Eigen::Vector3d at(int frame, int marker) const;
  void set(int frame, int marker, const Eigen::Vector3d& position);  ///< also marks it present
  void drop(int frame, int marker) { present[index(frame, marker)] = 0; }
  /// Marker number of a label, or -1.
  int find(const std::string& label) const;
  /// The frame that stands for frame `n` of the file: the one before it where it was taken out as repeated.
  int frame_of_file(int n) const;
  int file_of_frame(int f) const { return file_frames.empty() ? f : file_frames[static_cast<std::size_t>(f)]; }
  /// markers×3; rows of missing samples are NaN.
  Points frame(int f) const;

  static Take empty(std::string name, double rate_hz, std::vector<std::string> labels, int frames);
};

/// Reads .c3d, .trc or .csv by extension and content; converts to millimetres, +y up, and says in `decisions` what it
/// decided. `unit`/`up_axis` override the guess ("mm", "cm", "m", "in"; "x", "-x", "y", "-y", "z", "-z").
struct ReadOptions {
  std::string unit;          ///< empty: from the file's parameters, else from the spread of the markers
  std::string up_axis;       ///< empty: from the file's parameters, else y
  double mm_per_unit = 0.0;  ///< positive: overrides `unit`, for files in a unit of their own
  double rate_hz = 0.0;      ///< positive: overrides the file's frame rate
};
Take read_take(const std::filesystem::path& file, const ReadOptions& options = {});
/// Writes .c3d or .trc by extension; missing samples stay missing.
void write_take(const std::filesystem::path& file, const Take& take);

}  // namespace vultus::mocap
