#include "apps/virtual_stage/volume_faults.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/random.h"

namespace vultus::virtual_stage {
namespace {

enum Stream : std::uint64_t { swap_stream = 61, phantom_stream, fragment_stream, slip_stream };

void check(bool in_range, const std::string& option, const std::string& range) {
  if (!in_range) throw UsageError("fault option " + option + " must be " + range);
}

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
    const Eigen::Vector3d way =
        Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized() * options_.slip_mm;
    const double length = std::max(1.0, 0.15 * recorded_.take.rate_hz);
    result_.slipped_marker = marker;
    result_.slip_first = static_cast<int>(options_.slip_at * frames_);
    result_.slip_last = std::min(frames_ - 1, result_.slip_first + static_cast<int>(length));
    for (int f = result_.slip_first; f < frames_; ++f) {
      const double t = std::min(1.0, (f - result_.slip_first) / length), eased = t * t * (3.0 - 2.0 * t);
      if (!result_.take.has(f, marker)) continue;
      const Eigen::Matrix3d& turn = recorded_.volume_from_face[static_cast<std::size_t>(f)].rotation;
      result_.take.set(f, marker, result_.take.at(f, marker) + eased * (turn * way));
    }
  }

  void swaps() {
    Random random(options_.seed, swap_stream);
    for (int left = places(options_.swaps), tries = 0; left > 0 && tries < 1000 * left; ++tries) {
      const int length = static_cast<int>(10.0 * std::pow(20.0, random.uniform()));
      const int first = 5 + random.below(std::max(1, frames_ - 10)), last = std::min(first + length, frames_) - 1;
      std::vector<int> ring = {random.below(markers_)};
      const std::vector<int> near = neighbours(ring[0], first);
      ring.push_back(near[static_cast<std::size_t>(random.below(3))]);
      if (random.uniform() < 0.1) ring.push_back(near[3]);
      const bool after_absence = random.uniform() < 0.7;
      const int absence = 1 + random.below(6), absent = static_cast<int>(ring[random.uniform() < 0.5 ? 0 : 1]);
      if (!is_free(ring, first - 8, last + 8)) continue;
      if (after_absence) lose(absent, first - absence, first - 1);
      exchange(ring, first, last);
      take_up(ring, first, last);
      result_.faults.push_back({Fault::Kind::swap, first, last, ring});
      --left;
    }
  }

  void phantoms() {
    Random random(options_.seed, phantom_stream);
    for (int left = places(options_.phantoms), tries = 0; left > 0 && tries < 1000 * left; ++tries) {
      const int marker = random.below(markers_), length = 4 + random.below(60);
      const int first = 5 + random.below(std::max(1, frames_ - 10)), last = std::min(first + length, frames_) - 1;
      const Eigen::Vector3d away =
          Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized() * random.uniform(6.0, 35.0);
      const Eigen::Vector3d drift(random.normal(), random.normal(), random.normal());
      const bool labelled = random.uniform() < 0.6;
      if (!is_free({marker}, first - 8, last + 8)) continue;
      const int column = labelled ? marker : new_column();
      if (labelled) lose(marker, first, last);
      for (int f = first; f <= last; ++f) {
        const Eigen::Vector3d place = recorded_.clean.at(f, marker) + away + 0.04 * (f - first) * drift +
                                      0.15 * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
        put(f, column, recorded_.volume_from_face[static_cast<std::size_t>(f)] * place, FaultyTake::phantom);
      }
      take_up({marker}, first, last);
      result_.faults.push_back({labelled ? Fault::Kind::phantom : Fault::Kind::stray_phantom, first, last, {marker}});
      --left;
    }
  }

  void fragments() {
    Random random(options_.seed, fragment_stream);
    for (int left = places(options_.fragments), tries = 0; left > 0 && tries < 1000 * left; ++tries) {
      const int marker = random.below(markers_), length = 8 + random.below(150);
      const int first = 5 + random.below(std::max(1, frames_ - 10)), last = std::min(first + length, frames_) - 1;
      if (!is_free({marker}, first - 8, last + 8)) continue;
      const int column = new_column();
      for (int f = first; f <= last; ++f) {
        if (source_[at(f, marker)] < 0) continue;
        put(f, column, result_.take.at(f, marker), marker);
        lose(marker, f, f);
      }
      take_up({marker}, first, last);
      result_.faults.push_back({Fault::Kind::fragment, first, last, {marker}});
      --left;
    }
  }

  FaultyTake finish() {
    const auto columns = static_cast<std::size_t>(markers_ + static_cast<int>(extra_.size()));
    std::vector<std::string> labels = recorded_.take.labels;
    for (std::size_t e = 0; e < extra_.size(); ++e) labels.push_back("*" + std::to_string(e + 1));
    mocap::Take take = mocap::Take::empty(recorded_.take.name, recorded_.take.rate_hz, labels, frames_);
    result_.owners.assign(static_cast<std::size_t>(frames_) * columns, FaultyTake::nobody);
    for (int f = 0; f < frames_; ++f) {
      for (int m = 0; m < markers_; ++m) {
        if (source_[at(f, m)] == FaultyTake::nobody) continue;
        take.set(f, m, result_.take.at(f, m));
        result_.owners[take.index(f, m)] = source_[at(f, m)];
      }
    }
    for (std::size_t e = 0; e < extra_.size(); ++e) {
      for (const Stray& stray : extra_[e]) {
        const int column = markers_ + static_cast<int>(e);
        take.set(stray.frame, column, stray.place);
        result_.owners[take.index(stray.frame, column)] = stray.owner;
      }
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
  int places(double in_10000) const { return static_cast<int>(std::lround(in_10000 * frames_ / 10000.0)); }

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
    for (int f = std::max(0, first); f <= std::min(frames_ - 1, last); ++f) {
      for (const int m : markers)
        if (busy_[at(f, m)]) return false;
    }
    return first >= 0;
  }
  void take_up(const std::vector<int>& markers, int first, int last) {
    for (int f = first; f <= last; ++f)
      for (const int m : markers) busy_[at(f, m)] = 1;
  }

  void lose(int marker, int first, int last) {
    for (int f = std::max(0, first); f <= last; ++f) {
      result_.take.drop(f, marker);
      source_[at(f, marker)] = FaultyTake::nobody;
    }
  }

  // Each marker's sample goes to the label of the next in the ring.
  void exchange(const std::vector<int>& ring, int first, int last) {
    const mocap::Take before = result_.take;
    for (int f = first; f <= last; ++f) {
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const int from = ring[i], to = ring[(i + 1) % ring.size()];
        if (!before.has(f, from)) {
          lose(to, f, f);
          continue;
        }
        result_.take.set(f, to, before.at(f, from));
        source_[at(f, to)] = from;
      }
    }
  }

  int new_column() {
    extra_.emplace_back();
    return markers_ + static_cast<int>(extra_.size()) - 1;
  }
  void put(int frame, int column, const Eigen::Vector3d& place, int owner) {
    if (column >= markers_) {
      extra_[static_cast<std::size_t>(column - markers_)].push_back({frame, place, owner});
    } else {
      result_.take.set(frame, column, place);
      source_[at(frame, column)] = owner;
    }
  }

  const RecordedTake& recorded_;
  const FaultOptions& options_;
  int markers_ = 0, frames_ = 0;
  std::vector<std::uint8_t> busy_;
  std::vector<int> source_;  // who is under each label
  std::vector<std::vector<Stray>> extra_;
  FaultyTake result_;
};

bool same_place(const mocap::Take& a, int column_a, const mocap::Take& b, int column_b, int frame) {
  const float* p = a.positions.data() + 3 * a.index(frame, column_a);
  const float* q = b.positions.data() + 3 * b.index(frame, column_b);
  return std::equal(p, p + 3, q);
}

// Whether the sample is where it belongs.
bool is_right(const FaultyTake& faulty, const mocap::Take& repaired, int frame, int column, int owner) {
  if (owner >= 0) return repaired.has(frame, owner) && same_place(faulty.take, column, repaired, owner, frame);
  for (int m = 0; m < repaired.markers(); ++m) {
    if (repaired.has(frame, m) && same_place(faulty.take, column, repaired, m, frame)) return false;
  }
  return true;
}

}  // namespace

void FaultOptions::validate() const {
  for (const double rate : {swaps, phantoms, fragments}) check(rate >= 0 && rate <= 1000, "rate", "0 … 1000");
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
  return tracker.finish();
}

LabelScore score_labels(const FaultyTake& faulty, const mocap::Take& repaired) {
  LabelScore score;
  const int columns = faulty.take.markers();
  std::vector<std::uint8_t> wrong(faulty.owners.size(), 0);
  for (int f = 0; f < faulty.take.frames(); ++f) {
    for (int c = 0; c < columns; ++c) {
      const int owner = faulty.owners[faulty.take.index(f, c)];
      if (owner == FaultyTake::nobody) continue;
      const bool right = is_right(faulty, repaired, f, c, owner);
      ++score.samples;
      score.right += right;
      wrong[faulty.take.index(f, c)] = !right;
    }
  }
  for (const Fault& fault : faulty.faults) {
    if (fault.kind != Fault::Kind::swap) continue;
    bool left = false;
    for (int f = fault.first; f <= fault.last; ++f) {
      for (const int m : fault.markers) {
        if (faulty.owners[faulty.take.index(f, m)] == FaultyTake::nobody) continue;
        ++score.samples_in_swaps;
        const bool bad = wrong[faulty.take.index(f, m)] != 0;
        score.right_in_swaps += !bad;
        left = left || bad;
      }
    }
    score.swaps_left += left;
  }
  return score;
}

}  // namespace vultus::virtual_stage
