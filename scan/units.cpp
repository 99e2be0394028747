#include "scan/units.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "core/error.h"

namespace vultus::scan {
namespace {

// A few stray points must not decide: the extent of the middle 98 % along one axis.
double extent(const Points& positions, const std::vector<int>& rows, int axis) {
  std::vector<double> values;
  values.reserve(rows.size());
  for (int v : rows) values.push_back(positions(v, axis));
  const auto cut = static_cast<std::ptrdiff_t>(values.size() / 100);
  const auto low = values.begin() + cut, high = values.end() - 1 - cut;
  std::nth_element(values.begin(), low, values.end());
  const double least = *low;
  std::nth_element(values.begin(), high, values.end());
  return *high - least;
}

}  // namespace

Units guess_units(const Points& positions) {
  // A sample settles it: every vertex of scans below a million.
  const auto step = std::max<Eigen::Index>(1, positions.rows() / 1'000'000);
  std::vector<int> finite;
  for (Eigen::Index v = 0; v < positions.rows(); v += step)
    if (positions.row(v).allFinite()) finite.push_back(static_cast<int>(v));
  if (finite.empty()) throw InputError("units cannot be guessed: no finite vertex");
  Eigen::Vector3d size;
  for (int axis = 0; axis < 3; ++axis) size[axis] = extent(positions, finite, axis);
  for (const auto& [name, scale] : {std::pair("mm", 1.0), std::pair("cm", 10.0), std::pair("m", 1000.0),
                                    std::pair("micrometres", 0.001), std::pair("inches", 25.4)})
    if (size.norm() * scale >= 120.0 && size.norm() * scale < 1200.0) return {name, scale, true, true};
  return {"unknown, taken as mm", 1.0, false, true};
}

}  // namespace vultus::scan
