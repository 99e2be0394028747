#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace vultus {

/// Row-major n-dimensional float32 array, the on-disk form of weights and other dense results (NumPy .npy, C order).
struct Array {
  std::vector<std::size_t> shape;
  std::vector<float> values;

  static Array zeros(std::vector<std::size_t> shape);
  std::size_t size() const { return values.size(); }
};

/// Reads little-endian float32, float64 or int32 `.npy` (C order) as float32; throws `InputError` for other types,
/// Fortran order, and a shape that does not fit the file's size exactly. Values may be NaN.
Array read_npy(const std::filesystem::path& file);
void write_npy(const std::filesystem::path& file, const Array& array);

}  // namespace vultus
