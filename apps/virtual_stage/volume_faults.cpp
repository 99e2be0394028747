#include "apps/virtual_stage/volume_faults.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "core/error.h"
#include "core/random.h"

namespace vultus::virtual_stage {
namespace {

enum Stream : std::uint64_t {
  swap_stream = 61,
  phantom_stream,
  fragment_stream,
  slip_stream,
  spike_stream,
  dropout_stream,
  held_stream
};

void check(bool in_range, const std::string& option, const std::string& range) {
  if (!in_range) throw UsageError("fault option " + option + " must be " + range);
}

Eigen::Vector3d normals(Random& random) {
  const double x = random.normal(), y = random.normal(), z = random.normal();
  return {x, y, z};
}

struct Stretch {
  int first, last;
};

// No two faults share a marker within `kMargin` frames, so that each can be told by itself.
constexpr int kMargin = 8;

class Tracker {
 public:
  Tracker(const RecordedTake& recorded, const FaultOptions& options) : recorded_(recorded), options_(options) {
    result_.take = recorded.take;
    markers_ = recorded.take.markers();
    frames_ = recorded.take.frames();
    busy_.assign(recorded.take.present.size(), 0);
    source_.resize(recorded.take.present.size());
    for (int f = 0; f < frames_; ++f) {
      for (int m = 0; m < markers_; ++m) source_[at(f, m)] = recorded.take.has(f, m) ? m : FaultyTake::nobody;
    }
  }

  void slip(int jig_markers) {
    if (options_.slip_mm <= 0.0 || jig_markers == 0) return;
    Random random(options_.seed, slip_stream);
    const int marker = markers_ - jig_markers + random.below(jig_markers);
    const Eigen::Vector3d way = normals(random).normalized() * options_.slip_mm;
    const double length = std::max(1.0, 0.15 * recorded_.take.rate_hz);
    result_.slipped_marker = marker;
    result_.slip_first = static_cast<int>(options_.slip_at * frames_);
    result_.slip_last = std::min(frames_ - 1, result_.slip_first + static_cast<int>(length));
    for (int f = result_.slip_first; f < frames_; ++f) {
      const double t = std::min(1.0, (f - result_.slip_first) / length), eased = t * t * (3.0 - 2.0 * t);
      if (result_.take.has(f, marker)) move(f, marker, eased * way);
    }
  }

  void swaps() {
    scatter(swap_stream, options_.swaps, [&](Random& random) {
      const auto [first, last] = stretch(random, static_cast<int>(10.0 * std::pow(20.0, random.uniform())));
      std::vector<int> ring = {random.below(markers_)};
      const std::vector<int> near = neighbours(ring[0], first);
      ring.push_back(near[static_cast<std::size_t>(random.below(3))]);
      if (random.uniform() < 0.1) ring.push_back(near[3]);
      const bool after_absence = random.uniform() < 0.7;
      const int absence = 1 + random.below(6), absent = ring[random.uniform() < 0.5 ? 0 : 1];
      if (!is_free(ring, first, last)) return false;
      if (after_absence) lose(absent, first - absence, first - 1);
      exchange(ring, first, last);
      note({Fault::Kind::swap, first, last, ring});
      return true;
    });
  }

  void phantoms() {
    scatter(phantom_stream, options_.phantoms, [&](Random& random) {
      const int marker = random.below(markers_), length = 4 + random.below(60);
      const auto [first, last] = stretch(random, length);
      const Eigen::Vector3d way = normals(random).normalized(), away = way * random.uniform(6.0, 35.0);
      const Eigen::Vector3d drift = normals(random);
      const bool labelled = random.uniform() < 0.6;
      if (!is_free({marker}, first, last)) return false;
      if (labelled) lose(marker, first, last);
      const int column = labelled ? marker : new_column();
      for (int f = first; f <= last; ++f) {
        const Eigen::Vector3d place =
            recorded_.clean.at(f, marker) + away + 0.04 * (f - first) * drift + 0.15 * normals(random);
        put(f, column, recorded_.volume_from_face[static_cast<std::size_t>(f)] * place, FaultyTake::phantom);
      }
      note({labelled ? Fault::Kind::phantom : Fault::Kind::stray_phantom,
            first,
            last,
            {marker},
            labelled ? -1 : column});
      return true;
    });
  }

  void fragments() {
    scatter(fragment_stream, options_.fragments, [&](Random& random) {
      const int marker = random.below(markers_), length = 8 + random.below(150);
      const auto [first, last] = stretch(random, length);
      if (!is_free({marker}, first, last)) return false;
      const int column = new_column();
      for (int f = first; f <= last; ++f) {
        if (source_[at(f, marker)] < 0) continue;
        put(f, column, result_.take.at(f, marker), marker);
        lose(marker, f, f);
      }
      note({Fault::Kind::fragment, first, last, {marker}, column});
      return true;
    });
  }

  void spikes() {
    scatter(spike_stream, options_.spikes, [&](Random& random) {
      const int marker = random.below(markers_), length = 1 + random.below(2);
      const auto [first, last] = stretch(random, length);
      const double size = random.uniform(3.0, 30.0);
      const Eigen::Vector3d way = normals(random).normalized() * size;
      if (!is_free({marker}, first, last) || !is_seen(marker, first - 1, last + 1)) return false;
      for (int f = first; f <= last; ++f) move(f, marker, way);
      note({Fault::Kind::spike, first, last, {marker}, -1, size});
      return true;
    });
  }

  void dropouts() {
    scatter(dropout_stream, options_.dropouts, [&](Random& random) {
      const int marker = random.below(markers_), length = 1 + random.below(20);
      const auto [first, last] = stretch(random, length);
      if (!is_free({marker}, first, last)) return false;
      for (int f = first; f <= last; ++f) put(f, marker, Eigen::Vector3d::Zero(), FaultyTake::phantom);
      note({Fault::Kind::dropout, first, last, {marker}});
      return true;
    });
  }

  void held_frames() {
    std::vector<int> all(static_cast<std::size_t>(markers_));
    std::iota(all.begin(), all.end(), 0);
    scatter(held_stream, options_.held, [&](Random& random) {
      const int length = 1 + random.below(4);
      const auto [first, last] = stretch(random, length);
      if (!is_free(all, first, last)) return false;
      for (int f = first; f <= last; ++f) {
        for (const int m : all) {
          if (source_[at(first - 1, m)] == FaultyTake::nobody) {
            lose(m, f, f);
          } else {
            put(f, m, result_.take.at(first - 1, m), source_[at(first - 1, m)]);
          }
        }
      }
      note({Fault::Kind::held, first, last, all});
      return true;
    });
  }

  FaultyTake finish() {
    std::vector<std::string> labels = recorded_.take.labels;
    for (std::size_t e = 0; e < strays_.size(); ++e) labels.push_back("*" + std::to_string(e + 1));
    mocap::Take take = mocap::Take::empty(recorded_.take.name, recorded_.take.rate_hz, labels, frames_);
    result_.owners.assign(take.present.size(), FaultyTake::nobody);
    const auto add = [&](int f, int column, const Eigen::Vector3d& place, int owner) {
      take.set(f, column, place);
      result_.owners[take.index(f, column)] = owner;
    };
    for (int f = 0; f < frames_; ++f) {
      for (int m = 0; m < markers_; ++m) {
        if (source_[at(f, m)] != FaultyTake::nobody) add(f, m, result_.take.at(f, m), source_[at(f, m)]);
      }
    }
    for (std::size_t e = 0; e < strays_.size(); ++e) {
      for (const Stray& stray : strays_[e]) add(stray.frame, markers_ + static_cast<int>(e), stray.place, stray.owner);
    }
    result_.take = std::move(take);
    return std::move(result_);
  }

 private:
  struct Stray {
    int frame;
    Eigen::Vector3d place;
    int owner;
  };

  std::size_t at(int f, int m) const { return recorded_.take.index(f, m); }

  // Tries random places until there are as many as the rate asks for, or no room seems left.
  template <typename Place>
  void scatter(Stream stream, double in_10000, Place place) {
    Random random(options_.seed, stream);
    int left = static_cast<int>(std::lround(in_10000 * frames_ / 10000.0));
    for (int tries = 0; left > 0 && tries < 1000 * left; ++tries) left -= place(random);
  }

  Stretch stretch(Random& random, int length) const {
    const int first = 5 + random.below(std::max(1, frames_ - 10));
    return {first, std::min(first + length, frames_) - 1};
  }

  std::vector<int> neighbours(int marker, int frame) const {
    std::vector<int> order;
    for (int m = 0; m < markers_; ++m)
      if (m != marker) order.push_back(m);
    const auto distance = [&](int m) {
      return (recorded_.clean.at(frame, m) - recorded_.clean.at(frame, marker)).norm();
    };
    std::ranges::sort(order, {}, distance);
    return order;
  }

  bool is_free(const std::vector<int>& markers, int first, int last) const {
    if (first < kMargin) return false;
    for (int f = first - kMargin; f <= std::min(frames_ - 1, last + kMargin); ++f) {
      for (const int m : markers)
        if (busy_[at(f, m)]) return false;
    }
    return true;
  }

  bool is_seen(int marker, int first, int last) const {
    if (first < 0 || last >= frames_) return false;
    for (int f = first; f <= last; ++f)
      if (source_[at(f, marker)] != marker) return false;
    return true;
  }

  void note(Fault fault) {
    for (int f = fault.first; f <= fault.last; ++f)
      for (const int m : fault.markers) busy_[at(f, m)] = 1;
    result_.faults.push_back(std::move(fault));
  }

  void lose(int marker, int first, int last) {
    for (int f = std::max(0, first); f <= last; ++f) {
      result_.take.drop(f, marker);
      source_[at(f, marker)] = FaultyTake::nobody;
    }
  }

  // By a way that turns with the head.
  void move(int frame, int marker, const Eigen::Vector3d& way) {
    const Eigen::Matrix3d& turn = recorded_.volume_from_face[static_cast<std::size_t>(frame)].rotation;
    result_.take.set(frame, marker, result_.take.at(frame, marker) + turn * way);
  }

  // Each marker's sample goes to the label of the next in the ring.
  void exchange(const std::vector<int>& ring, int first, int last) {
    for (int f = first; f <= last; ++f) {
      std::vector<std::optional<Eigen::Vector3d>> places;
      for (const int m : ring)
        places.push_back(result_.take.has(f, m) ? std::optional(result_.take.at(f, m)) : std::nullopt);
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const int to = ring[(i + 1) % ring.size()];
        if (places[i]) {
          put(f, to, *places[i], ring[i]);
        } else {
          lose(to, f, f);
        }
      }
    }
  }

  int new_column() {
    strays_.emplace_back();
    return markers_ + static_cast<int>(strays_.size()) - 1;
  }
  void put(int frame, int column, const Eigen::Vector3d& place, int owner) {
    if (column >= markers_) {
      strays_[static_cast<std::size_t>(column - markers_)].push_back({frame, place, owner});
    } else {
      result_.take.set(frame, column, place);
      source_[at(frame, column)] = owner;
    }
  }

  const RecordedTake& recorded_;
  const FaultOptions& options_;
  int markers_ = 0, frames_ = 0;
  std::vector<std::uint8_t> busy_;
  std::vector<int> source_;                 // frames × markers: who is under each label
  std::vector<std::vector<Stray>> strays_;  // unlabelled trajectories
  FaultyTake result_;
};

}  // namespace

void FaultOptions::validate() const {
  for (const double rate : {swaps, phantoms, fragments, spikes, dropouts, held})
    check(rate >= 0 && rate <= 1000, "rate", "0 … 1000");
  check(slip_mm >= 0 && slip_mm <= 50, "slip_mm", "0 … 50 mm");
  check(slip_at >= 0 && slip_at <= 1, "slip_at", "0 … 1");
}

FaultyTake with_faults(const RecordedTake& recorded, int jig_markers, const FaultOptions& options) {
  options.validate();
  if (recorded.take.markers() < 5) throw UsageError("label faults need a take of 5 or more markers");
  Tracker tracker(recorded, options);
  tracker.slip(jig_markers);
  tracker.swaps();
  tracker.phantoms();
  tracker.fragments();
  tracker.spikes();
  tracker.dropouts();
  tracker.held_frames();
  return tracker.finish();
}

}  // namespace vultus::virtual_stage
