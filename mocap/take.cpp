#include "mocap/take.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <limits>

#include "core/error.h"
#include "mocap/c3d.h"
#include "mocap/csv.h"
#include "mocap/trc.h"

namespace vultus::mocap {

namespace {

std::string lower_extension(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return extension;
}

std::string first_bytes(const std::filesystem::path& file) {
  std::error_code problem;
  if (!std::filesystem::exists(file, problem)) throw InputError(file, "no such file");
  if (!std::filesystem::is_regular_file(file, problem)) throw InputError(file, "is not a plain file");
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw InputError(file, "cannot be opened for reading");
  std::string bytes(64, '\0');
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(stream.gcount()));
  return bytes;
}

}  // namespace

Eigen::Vector3d Take::at(int frame, int marker) const {
  return Eigen::Map<const Eigen::Vector3f>(positions.data() + 3 * index(frame, marker)).cast<double>();
}

void Take::set(int frame, int marker, const Eigen::Vector3d& position) {
  const std::size_t i = index(frame, marker);
  Eigen::Map<Eigen::Vector3f>(positions.data() + 3 * i) = position.cast<float>();
  present[i] = 1;
}

int Take::find(const std::string& label) const {
  const auto found = std::find(labels.begin(), labels.end(), label);
  return found == labels.end() ? -1 : static_cast<int>(found - labels.begin());
}

Points Take::frame(int f) const {
  Points points = Points::Constant(markers(), 3, std::numeric_limits<double>::quiet_NaN());
  for (int m = 0; m < markers(); ++m) {
    if (has(f, m)) points.row(m) = at(f, m).transpose();
  }
  return points;
}

int Take::frame_of_file(int n) const {
  if (file_frames.empty()) return n;
  const auto after = std::upper_bound(file_frames.begin(), file_frames.end(), n);
  if (after == file_frames.begin()) return 0;
  // Frames that the file lacks bear the number of the one before them.
  return static_cast<int>(std::lower_bound(file_frames.begin(), after, *(after - 1)) - file_frames.begin());
}

Take Take::empty(std::string name, double rate_hz, std::vector<std::string> labels, int frames) {
  Take take;
  take.name = std::move(name);
  take.rate_hz = rate_hz;
  take.labels = std::move(labels);
  const std::size_t samples = take.labels.size() * static_cast<std::size_t>(frames);
  take.positions.assign(3 * samples, 0.0F);
  take.present.assign(samples, 0);
  return take;
}

Take read_take(const std::filesystem::path& file, const ReadOptions& options) {
  const std::string start = first_bytes(file), extension = lower_extension(file);
  if (start.empty()) throw InputError(file, "is empty; a C3D, TRC or CSV file is expected");
  if (start.size() > 1 && start[1] == 'P' && static_cast<unsigned char>(start[0]) < 32) return read_c3d(file, options);
  if (start.starts_with("PathFileType") || extension == ".trc") return read_trc(file, options);
  if (extension == ".c3d") return read_c3d(file, options);
  if (extension == ".csv" || extension == ".tsv" || extension == ".txt") return read_csv(file, options);
  throw InputError(file, "is neither C3D nor TRC nor CSV by name or content");
}

void write_take(const std::filesystem::path& file, const Take& take) {
  const std::string extension = lower_extension(file);
  if (extension == ".c3d") return write_c3d(file, take);
  if (extension == ".trc") return write_trc(file, take);
  throw OutputError(file, "takes are written as .c3d or .trc");
}

}  // namespace vultus::mocap
