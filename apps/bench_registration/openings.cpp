#include "apps/bench_registration/openings.h"

#include <utility>

namespace vultus::apps::bench {
namespace {

using Pairs = std::vector<std::pair<int, int>>;

double gap(const registration::Ibug68& scheme, const Pairs& pairs, const Points& positions) {
  double sum = 0.0;
  for (const auto& [upper, lower] : pairs) sum += (positions.row(scheme[upper]) - positions.row(scheme[lower])).norm();
  return sum / static_cast<double>(pairs.size());
}

}  // namespace

std::vector<Opening> openings(const registration::Template& head, const Points& truth, const Points& found) {
  static const std::vector<std::pair<std::string, Pairs>> rims = {{"mouth", {{61, 67}, {62, 66}, {63, 65}}},
                                                                  {"right eye", {{37, 41}, {38, 40}}},
                                                                  {"left eye", {{43, 47}, {44, 46}}}};
  std::vector<Opening> result;
  if (!head.ibug68) return result;
  for (const auto& [name, pairs] : rims) {
    bool complete = true;
    for (const auto& [upper, lower] : pairs)
      complete = complete && (*head.ibug68)[upper] >= 0 && (*head.ibug68)[lower] >= 0;
    if (complete) result.push_back({name, gap(*head.ibug68, pairs, truth), gap(*head.ibug68, pairs, found)});
  }
  return result;
}

}  // namespace vultus::apps::bench
