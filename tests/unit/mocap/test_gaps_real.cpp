#include "mocap/gaps.h"
#include "mocap/stabilize.h"
#include "tests/unit/mocap/takes.h"

namespace vultus::mocap {
namespace {

/// The subject's face in millimetres: its pupils are 0.336 of the file's units apart, 62 mm on people.
Take blenderface_subject(const std::filesystem::path& data) {
  ReadOptions options;
  options.mm_per_unit = 185.0;
  options.rate_hz = 25.0;
  return stabilize(read_take(data / "Subject_01.csv", options)).take;
}

TEST(GapsReal, LongMissingStretchesAreHolesOrHonest) {
  const auto data = real_data() / "blenderface-markers";
  if (!std::filesystem::exists(data)) GTEST_SKIP() << "VULTUS_DATA has no blenderface-markers";
  const Take truth = blenderface_subject(data);
  Take take = truth;
  // Two seconds of four markers in turn, wherever all of it is known.
  std::vector<Gap> cuts;
  for (int first = 20; first + 80 < take.frames(); first += 90) {
    const int marker = static_cast<int>(cuts.size() * 5) % take.markers();
    bool seen = true;
    for (int f = first - 1; f <= first + 50; ++f) seen = seen && truth.has(f, marker);
    if (!seen) continue;
    cuts.push_back({marker, first, first + 49});
    for (int f = first; f < first + 50; ++f) take.drop(f, marker);
  }
  ASSERT_GE(cuts.size(), 3U);
  const FillOptions options;
  const Filled filled = fill_gaps(take, options);
  int known = 0, fiction = 0;
  for (const Gap& cut : cuts) {
    for (int f = cut.first; f <= cut.last; ++f) {
      if (!filled.take.has(f, cut.marker)) continue;
      const double error = (filled.take.at(f, cut.marker) - truth.at(f, cut.marker)).norm();
      ++known;
      fiction += error > 4.0 * filled.expected_errors[take.index(f, cut.marker)];
    }
  }
  // The error stated is a 70 % quantile; of a Gaussian's samples, one in a hundred thousand would be four times as far.
  EXPECT_LE(fiction, known / 20);
  for (const Gap& gap : filled.gaps) {
    if (gap.method == Origin::missing) {
      EXPECT_FALSE(filled.take.has(gap.first, gap.marker));
      continue;
    }
    EXPECT_LE(gap.expected_error, options.hole_above_mm);
    // A gap closed on both sides is least sure in its middle.
    if (gap.frames() < 25 || gap.first == 0 || gap.last + 1 == take.frames()) continue;
    const auto error = [&](int f) { return filled.expected_errors[take.index(f, gap.marker)]; };
    EXPECT_GE(error((gap.first + gap.last) / 2), std::min(error(gap.first), error(gap.last)));
  }
}

}  // namespace
}  // namespace vultus::mocap
