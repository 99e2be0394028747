#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mocap/c3d_bytes.h"
#include "mocap/c3d_parameters.h"

namespace vultus::mocap {

/// The fixed header of a C3D file.
struct C3dHeader {
  int parameter_block = 0, points = 0, analog_per_frame = 0, first_frame = 0, last_frame = 0, data_block = 0;
  double scale = 0.0, rate_hz = 0.0;
};

/// Where the samples of a C3D file are and how they are stored.
struct C3dLayout {
  int points = 0;
  std::uint64_t frames = 0;
  int analog_per_frame = 0;  ///< analog values that follow the points of each frame
  bool real = true;
  double scale = 1.0;             ///< file units per integer step, and per step of the residuals
  std::uint64_t data_offset = 0;  ///< bytes

  std::uint64_t value_bytes() const { return real ? 4 : 2; }
  std::uint64_t stride() const { return (4 * static_cast<std::uint64_t>(points) + analog_per_frame) * value_bytes(); }
};

/// Everything of a C3D file before its samples.
struct C3dHead {
  Decoder decoder;
  C3dHeader header;
  C3dParameters parameters;
  C3dLayout layout;
};

/// Reads header and parameters and settles the layout: of the counts and offsets that header and parameters give, the
/// first combination that fills the file to its last block; else the only one with frames beyond 16 bits, or with real
/// samples under an integer's scale, that does. Throws `InputError` when none fits into the file.
C3dHead read_c3d_head(FileBytes& file, std::vector<std::string>& decisions);

}  // namespace vultus::mocap
