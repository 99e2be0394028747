#include "apps/bench_registration/openings.h"

#include <utility>

namespace vultus::apps::bench {
namespace {

using Pairs = std::vector<std::pair<int, int>>;

constexpr double scheme_thickness = 1.0;  // mm between the scheme's points on either side of closed lips

double gap(const Pairs& pairs, const Points& positions) {
  double sum = 0.0;
  for (const auto& [upper, lower] : pairs) sum += (positions.row(upper) - positions.row(lower)).norm();
  return sum / static_cast<double>(pairs.size());
}

// Empty where the template does not name them all.
Pairs of_scheme(const registration::Template& head, const Pairs& points) {
  Pairs pairs;
  if (!head.ibug68) return pairs;
  for (const auto& [upper, lower] : points) {
    pairs.emplace_back((*head.ibug68)[upper], (*head.ibug68)[lower]);
    if (pairs.back().first < 0 || pairs.back().second < 0) return {};
  }
  return pairs;
}

}  // namespace

std::vector<Opening> openings(const registration::Template& head, const Points& truth, const Points& found) {
  static const std::vector<std::pair<std::string, Pairs>> scheme = {{"lips", {{61, 67}, {62, 66}, {63, 65}}},
                                                                    {"right lids", {{37, 41}, {38, 40}}},
                                                                    {"left lids", {{43, 47}, {44, 46}}}};
  std::vector<Opening> result;
  for (const auto& [name, points] : scheme) {
    Pairs pairs = of_scheme(head, points);
    double thickness = scheme_thickness;
    for (const registration::TouchingRims& rims : head.rims)
      if (rims.name == name && !rims.pairs.empty()) {
        pairs = rims.pairs;
        thickness = 0.0;
      }
    if (!pairs.empty()) result.push_back({name, gap(pairs, truth), gap(pairs, found), thickness});
  }
  return result;
}

}  // namespace vultus::apps::bench
