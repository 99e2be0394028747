#include "mocap/hole_reasons.h"

#include <map>

namespace vultus::mocap {

namespace {

constexpr int kLeastOthers = 3;  // place a group of markers in space

/// Frames of the gap in which too few other markers were measured to say anything.
int lonely_frames(const CleanReport& report, const Gap& gap) {
  int lonely = 0;
  const std::size_t markers = report.labels.size();
  for (int f = gap.first; f <= gap.last; ++f) {
    int others = 0;
    for (std::size_t m = 0; m < markers; ++m)
      others += report.origins[static_cast<std::size_t>(f) * markers + m] == Origin::measured;
    lonely += others < kLeastOthers;
  }
  return lonely;
}

enum class Reason { never_seen, lonely, unsure };

Reason reason_of(const CleanReport& report, const Gap& gap) {
  if (gap.frames() * report.labels.size() == report.origins.size()) return Reason::never_seen;
  return lonely_frames(report, gap) > 0 ? Reason::lonely : Reason::unsure;
}

}  // namespace

std::string hole_reason(const CleanReport& report, const Gap& gap) {
  switch (reason_of(report, gap)) {
    case Reason::never_seen:
      return "the marker is never seen";
    case Reason::lonely:
      return "fewer than three other markers are seen in " + std::to_string(lonely_frames(report, gap)) + " of its " +
             std::to_string(gap.frames()) + " frames";
    case Reason::unsure:
      break;
  }
  return "the expected error is too large";
}

std::vector<std::string> hole_reasons(const CleanReport& report) {
  std::map<Reason, int> counts;
  for (const Gap& gap : report.gaps)
    if (gap.method == Origin::missing) ++counts[reason_of(report, gap)];
  std::vector<std::string> lines;
  for (const auto& [reason, count] : counts) {
    lines.push_back("holes: " + std::to_string(count) +
                    (reason == Reason::never_seen ? " of markers that are never seen"
                     : reason == Reason::lonely   ? " where fewer than three other markers are seen"
                                                  : " whose expected error is too large"));
  }
  return lines;
}

}  // namespace vultus::mocap
