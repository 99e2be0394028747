#include "mocap/axes.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cctype>
#include <cmath>

#include "core/error.h"
#include "core/number_text.h"
#include "core/statistics.h"

namespace vultus::mocap {

namespace {

std::string lower(const std::string& text) {
  std::string result;
  for (const unsigned char c : text) {
    if (!std::isspace(c)) result.push_back(static_cast<char>(std::tolower(c)));
  }
  return result;
}

std::optional<Eigen::Vector3i> axis(const std::string& name) {
  std::string letter = lower(name);
  int sign = 1;
  if (!letter.empty() && (letter[0] == '+' || letter[0] == '-')) {
    sign = letter[0] == '-' ? -1 : 1;
    letter.erase(0, 1);
  }
  if (letter.size() != 1 || letter[0] < 'x' || letter[0] > 'z') return {};
  return sign * Eigen::Vector3i::Unit(letter[0] - 'x');
}

/// Median over frames of the RMS distance of the markers from their centre, in file units; 0 without data.
double spread(const Take& take) {
  std::vector<double> spreads;
  const int step = std::max(1, take.frames() / 200);
  for (int f = 0; f < take.frames(); f += step) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double squares = 0.0;
    int n = 0;
    for (int m = 0; m < take.markers(); ++m) {
      if (!take.has(f, m)) continue;
      sum += take.at(f, m);
      squares += take.at(f, m).squaredNorm();
      ++n;
    }
    if (n > 2) spreads.push_back(std::sqrt(std::max(0.0, squares / n - (sum / n).squaredNorm())));
  }
  return spreads.empty() ? 0.0 : median(std::move(spreads));
}

double decide_unit(Take& take, const FileConvention& convention, const ReadOptions& options) {
  if (options.mm_per_unit > 0.0) {
    take.decisions.push_back("units: " + number(options.mm_per_unit, "%.4g") + " mm each, as asked");
    return options.mm_per_unit;
  }
  if (!options.unit.empty()) {
    const auto mm = mm_of_unit(options.unit);
    if (!mm) throw InputError("unit '" + options.unit + "' is not known; mm, cm, m and in are");
    take.decisions.push_back("units: " + options.unit + ", as asked");
    return *mm;
  }
  if (const auto mm = mm_of_unit(convention.unit)) {
    take.decisions.push_back("units: " + convention.unit + ", from the file");
    return *mm;
  }
  // A face's markers spread some 50 to 100 mm about their centre, a body's 400 to 800: the two ranges of one unit do
  // not touch those of the next.
  const double extent = spread(take);
  const char* unit = extent == 0.0 || extent > 30.0 ? "mm" : (extent > 2.0 ? "cm" : "m");
  take.decisions.push_back(std::string("units: ") + unit + ", guessed from a spread of the markers of " +
                           number(extent, "%.4g") + " (the file says " +
                           (convention.unit.empty() ? "nothing" : "'" + convention.unit + "'") + ")");
  return *mm_of_unit(unit);
}

Eigen::Matrix3i decide_axes(Take& take, const FileConvention& convention, const ReadOptions& options) {
  if (!options.up_axis.empty()) {
    const auto axes = axes_from_up(options.up_axis);
    if (!axes) throw InputError("up axis '" + options.up_axis + "' is not known; x, -x, y, -y, z and -z are");
    take.decisions.push_back("up axis: " + options.up_axis + ", as asked");
    return *axes;
  }
  if (const auto axes = axes_from_screen(convention.right, convention.up)) {
    take.decisions.push_back("up axis: " + convention.up + ", right: " + convention.right + ", from the file");
    return *axes;
  }
  if (const auto axes = axes_from_up(convention.up)) {
    take.decisions.push_back("up axis: " + convention.up + ", from the file");
    return *axes;
  }
  take.decisions.push_back("up axis: y, as the file says nothing");
  return Eigen::Matrix3i::Identity();
}

}  // namespace

std::optional<double> mm_of_unit(const std::string& name) {
  static const std::pair<const char*, double> units[] = {
      {"mm", 1.0},   {"millimeter", 1.0},  {"millimeters", 1.0},  {"millimetre", 1.0},  {"millimetres", 1.0},
      {"cm", 10.0},  {"centimeter", 10.0}, {"centimeters", 10.0}, {"centimetre", 10.0}, {"centimetres", 10.0},
      {"m", 1000.0}, {"meter", 1000.0},    {"meters", 1000.0},    {"metre", 1000.0},    {"metres", 1000.0},
      {"in", 25.4},  {"inch", 25.4},       {"inches", 25.4}};
  const std::string wanted = lower(name);
  for (const auto& [unit, mm] : units) {
    if (wanted == unit) return mm;
  }
  return {};
}

std::optional<Eigen::Matrix3i> axes_from_up(const std::string& up) {
  const auto y = axis(up);
  if (!y) return {};
  // Keeping the third axis of x-up and y-up files and the first one of the others makes every turn the shortest.
  Eigen::Matrix3i axes;
  const Eigen::Vector3i kept = y->x() != 0 ? Eigen::Vector3i::UnitZ() : Eigen::Vector3i::UnitX();
  const Eigen::Vector3i right = y->x() != 0 ? y->cross(kept) : kept;
  axes.row(0) = right.transpose();
  axes.row(1) = y->transpose();
  axes.row(2) = right.cross(*y).transpose();
  return axes;
}

std::optional<Eigen::Matrix3i> axes_from_screen(const std::string& right, const std::string& up) {
  const auto x = axis(right), y = axis(up);
  if (!x || !y || x->dot(*y) != 0) return {};
  Eigen::Matrix3i axes;
  axes.row(0) = x->transpose();
  axes.row(1) = y->transpose();
  axes.row(2) = x->cross(*y).transpose();
  return axes;
}

void to_our_frame(Take& take, const FileConvention& convention, const ReadOptions& options) {
  const double mm = decide_unit(take, convention, options);
  const Eigen::Matrix3i axes = decide_axes(take, convention, options);
  if (mm == 1.0 && axes.isIdentity()) return;  // bit for bit as stored
  const Eigen::Matrix3f turn = axes.cast<float>();
  std::size_t beyond = 0;  // samples that no float holds in millimetres
  for (std::size_t i = 0; i < take.present.size(); ++i) {
    Eigen::Map<Eigen::Vector3f> p(take.positions.data() + 3 * i);
    const Eigen::Vector3f turned = turn * p;
    p = mm == 1.0 ? turned : Eigen::Vector3f((turned.cast<double>() * mm).cast<float>());
    if (take.present[i] == 0 || p.allFinite()) continue;
    take.present[i] = 0;
    p.setZero();
    ++beyond;
  }
  if (beyond > 0) {
    take.decisions.push_back("samples: " + std::to_string(beyond) + " beyond all measure taken as missing");
  }
  for (float& residual : take.residuals) residual = static_cast<float>(residual * mm);
  take.residual_step = static_cast<float>(take.residual_step * mm);
}

}  // namespace vultus::mocap
