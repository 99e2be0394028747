#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "mocap/take.h"

namespace vultus::mocap {

/// How a file's coordinates become ours: `ours = mm_per_unit * axes * file`.
struct FileFrame {
  double mm_per_unit = 1.0;
  Eigen::Matrix3i axes = Eigen::Matrix3i::Identity();  ///< a rotation made of 0 and ±1
};

/// Millimetres of a unit name ("mm", "cm", "m", "in", also spelled out, any case); nothing for an unknown one.
std::optional<double> mm_of_unit(const std::string& name);

/// Rotation that brings `up` ("z", "-x", "+Y", …) to +y by the shortest turn; nothing for an unknown name.
std::optional<Eigen::Matrix3i> axes_from_up(const std::string& up);

/// The same with the axis to the right on screen too (C3D's X_SCREEN and Y_SCREEN).
std::optional<Eigen::Matrix3i> axes_from_screen(const std::string& right, const std::string& up);

/// What a file says about itself; empty where it says nothing.
struct FileConvention {
  std::string unit, right, up;
};

/// Brings a take in file coordinates to millimetres and +y up by `options`, else by `convention`, else (the unit) by
/// the spread of the markers; says what was done in `take.decisions`. Throws `InputError` for option values that are
/// no unit or axis.
void to_our_frame(Take& take, const FileConvention& convention, const ReadOptions& options);

}  // namespace vultus::mocap
