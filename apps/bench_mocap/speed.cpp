#include "apps/bench_mocap/speed.h"

#include <malloc.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <functional>

#include "apps/bench_mocap/long_take.h"
#include "apps/bench_mocap/mocap_bench.h"
#include "apps/bench_registration/peak_memory.h"
#include "mocap/clean.h"

namespace vultus::apps::bench_mocap {
namespace {

namespace fs = std::filesystem;
using bench::peak_memory, bench::reset_peak_memory, bench::resident_memory;

/// A folder of this process's own, gone with the object.
class TemporaryFolder {
 public:
  TemporaryFolder() : path_(fs::temp_directory_path() / ("vultus_bench_" + std::to_string(::getpid()))) {
    fs::create_directories(path_);
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  fs::path operator/(const std::string& name) const { return path_ / name; }

 private:
  fs::path path_;
};

struct Measured {
  double seconds = 0.0, added_bytes = 0.0;
};

Measured measured(const std::function<void()>& work) {
  ::malloc_trim(0);  // what earlier work has freed must not hide what this work takes
  reset_peak_memory();
  const double before = resident_memory();
  const auto start = std::chrono::steady_clock::now();
  work();
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
  return {spent.count(), peak_memory() - before};
}

nlohmann::json ratio(double bytes, double of) {
  return peak_memory() > 0.0 ? nlohmann::json(bytes / of) : nlohmann::json(nullptr);
}

double bytes_of(const mocap::Take& take) {
  return static_cast<double>(4 * (take.positions.size() + take.residuals.size()) + take.present.size() +
                             take.cameras.size());
}

/// Returns the files' float data (x, y, z and residual of every sample) in bytes.
double write_takes(const SpeedOptions& options, const TemporaryFolder& folder) {
  mocap::Take take = long_take({.seconds = options.seconds, .seed = options.seed});
  take.residuals.assign(take.present.size(), 0.3F);
  take.cameras.assign(take.present.size(), 0x15);
  take.residual_step = 0.01F;
  mocap::write_take(folder / "long.c3d", take);
  mocap::write_take(folder / "long.trc", take);
  return 16.0 * static_cast<double>(take.present.size());
}

}  // namespace

nlohmann::json mocap_speed(const SpeedOptions& options, Progress& progress) {
  progress.begin("speed", 4);
  const TemporaryFolder folder;
  const double data = write_takes(options, folder);
  progress.advance();
  nlohmann::json json = {{"float_data_bytes", data}};
  {
    mocap::Take take;
    const Measured read = measured([&] { take = mocap::read_take(folder / "long.c3d"); });
    json["read_seconds"] = read.seconds;
    json["read_memory_ratio"] = ratio(read.added_bytes, data);
    json["take_bytes"] = bytes_of(take);
  }
  progress.advance();
  progress.check();
  {
    mocap::Take take;
    const Measured read = measured([&] { take = mocap::read_take(folder / "long.trc"); });
    json["read_text_seconds"] = read.seconds;
    json["read_text_memory_ratio"] = ratio(read.added_bytes, data);
  }
  progress.advance();
  progress.check();
  const Measured cleaning = measured([&] {
    const mocap::Cleaned cleaned = mocap::clean(mocap::read_take(folder / "long.c3d"), {}, progress);
    mocap::write_take(folder / "clean.c3d", cleaned.take);
    mocap::write_samples(folder / "samples.json", cleaned.report);
    json["clean_frames"] = cleaned.take.frames();
    json["clean_markers"] = cleaned.take.markers();
  });
  json["clean_seconds"] = cleaning.seconds;
  json["clean_memory_ratio"] = ratio(cleaning.added_bytes, json["take_bytes"].get<double>());
  return json;
}

void measure_speed(const MocapBenchOptions& options, MocapFigures& figures, Progress& progress) {
  const nlohmann::json speed = mocap_speed({.seed = options.seed}, progress);
  figures.report["read_seconds"] = speed["read_seconds"];
  figures.report["clean_seconds"] = speed["clean_seconds"];
  figures.details["speed"] = speed;
  for (const auto& [name, value] : speed.items()) figures.lines.push_back(name + "," + value.dump());
}

}  // namespace vultus::apps::bench_mocap
