#include "apps/bench_mocap/long_take.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "apps/virtual_stage/mocap_volume.h"
#include "apps/virtual_stage/virtual_actor.h"
#include "core/random.h"
#include "register/template_head.h"

namespace vultus::apps::bench_mocap {
namespace {

constexpr double kRate = 120.0, kPerformed = 60.0;  // seconds
enum Stream : std::uint64_t { noise_stream = 1000, burst_stream = 1 };

/// The stage's layout and two more places between existing ones: 104 markers with the jig, as large sets have.
virtual_stage::MarkerLayout layout_of_104(const virtual_stage::FaceModel& actor, std::uint64_t seed) {
  virtual_stage::MarkerLayout layout = virtual_stage::marker_layout(actor, seed);
  for (const std::size_t of : {std::size_t{20}, std::size_t{60}}) {
    SurfacePoint place = layout.places[of];
    place.barycentric = Eigen::Vector3d::Constant(1.0 / 3.0);
    layout.labels.push_back("extra" + std::to_string(of));
    layout.places.push_back(place);
  }
  return layout;
}

virtual_stage::RecordedTake one_minute(double seconds, std::uint64_t seed) {
  const virtual_stage::VirtualActor actor(registration::template_head(), seed);
  virtual_stage::Performance all{"long", kRate, {}};
  for (const std::string& name : virtual_stage::performance_names()) {
    const auto part = virtual_stage::perform(name, seconds / 3.0, kRate, seed);
    all.frames.insert(all.frames.end(), part.frames.begin(), part.frames.end());
  }
  virtual_stage::VolumeOptions volume;
  volume.seed = seed;
  volume.noise = volume.missing = 0.0;
  return virtual_stage::record(actor.face(), layout_of_104(actor.face(), seed), all, volume);
}

/// Frame of the minute that shows in frame `f`: 0 … n-1, n-1 … 0, 0 …
int there_and_back(int f, int n) {
  const int place = f % (2 * n);
  return place < n ? place : 2 * n - 1 - place;
}

void lose_bursts(double share, std::uint64_t seed, mocap::Take& take) {
  Random random(seed, burst_stream);
  const auto wanted = static_cast<std::size_t>(share * static_cast<double>(take.present.size()));
  for (std::size_t lost = 0; lost < wanted;) {
    const int marker = random.below(take.markers()), first = random.below(take.frames());
    const int length = 3 + static_cast<int>(37.0 * std::pow(random.uniform(), 2.0));
    for (int f = first; f < std::min(take.frames(), first + length); ++f) {
      if (!take.has(f, marker)) continue;
      take.drop(f, marker);
      ++lost;
    }
  }
}

}  // namespace

mocap::Take long_take(const LongTakeOptions& options) {
  const auto minute = one_minute(std::min(options.seconds, kPerformed), options.seed);
  const int frames = static_cast<int>(std::lround(options.seconds * kRate)), performed = minute.take.frames();
  mocap::Take take = mocap::Take::empty("long", kRate, minute.take.labels, frames);
  tbb::parallel_for(0, frames, [&](int f) {
    Random random(options.seed, noise_stream + static_cast<std::uint64_t>(f));
    for (int m = 0; m < take.markers(); ++m) {
      const double x = random.normal(), y = random.normal(), z = random.normal();
      take.set(f, m, minute.take.at(there_and_back(f, performed), m) + options.noise * Eigen::Vector3d(x, y, z));
    }
  });
  lose_bursts(options.missing, options.seed, take);
  return take;
}

}  // namespace vultus::apps::bench_mocap
