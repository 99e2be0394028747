#include "tests/fuzz/reader.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <new>

#include "core/error.h"

namespace {

std::size_t largest_allocation = static_cast<std::size_t>(-1);  // bytes; no limit between inputs

[[noreturn]] void fail(const char* what) {
  std::fprintf(stderr, "fuzz: %s\n", what);
  std::abort();
}

void* allocated(std::size_t size) {
  if (size > largest_allocation) fail("an allocation beyond what the input can hold");
  if (void* memory = std::malloc(size == 0 ? 1 : size)) return memory;
  throw std::bad_alloc();
}

}  // namespace

void* operator new(std::size_t size) { return allocated(size); }
void* operator new[](std::size_t size) { return allocated(size); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }

namespace vultus::fuzz {

namespace {

/// One file in memory for the whole process.
class MemoryFile {
 public:
  MemoryFile() : descriptor_(::memfd_create("fuzz", 0)) {
    if (descriptor_ < 0) fail("no file in memory to be had");
  }
  std::filesystem::path path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }
  void fill(const std::uint8_t* data, std::size_t size) const {
    if (::ftruncate(descriptor_, 0) != 0 || ::pwrite(descriptor_, data, size, 0) != static_cast<ssize_t>(size)) {
      fail("the file in memory cannot be written");
    }
  }

 private:
  int descriptor_;
};

void check_take(const mocap::Take& take, std::size_t bytes) {
  const std::size_t samples = take.present.size();
  if (take.labels.empty() || samples == 0 || samples % take.labels.size() != 0) fail("a take without samples");
  if (take.positions.size() != 3 * samples) fail("positions and samples disagree");
  if (!take.residuals.empty() && take.residuals.size() != samples) fail("residuals and samples disagree");
  if (!take.cameras.empty() && take.cameras.size() != samples) fail("camera masks and samples disagree");
  if (samples > 2 * bytes) fail("more samples than the input can hold");  // twice: frames that times left out
  if (!(take.rate_hz > 0.0) || !std::isfinite(take.rate_hz)) fail("no frame rate");
  for (std::size_t i = 0; i < 3 * samples; ++i) {
    if (take.present[i / 3] != 0 && !std::isfinite(take.positions[i])) fail("a sample that is not finite");
  }
}

}  // namespace

void check_reader(const Read& read, const std::uint8_t* data, std::size_t size) {
  static const MemoryFile file;
  file.fill(data, size);
  const std::filesystem::path path = file.path();
  largest_allocation = (std::size_t{1} << 20) + 64 * size;
  try {
    check_take(read(path), size);
  } catch (const InputError&) {
  }
  largest_allocation = static_cast<std::size_t>(-1);
}

std::string written(const std::function<void(const std::filesystem::path&)>& write, const std::string& extension) {
  const auto path = std::filesystem::temp_directory_path() / ("vultus_fuzz_" + std::to_string(::getpid()) + extension);
  write(path);
  std::ifstream stream(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  std::filesystem::remove(path);
  return bytes;
}

mocap::Take small_take(int frames, int markers) {
  std::vector<std::string> labels;
  for (int m = 0; m < markers; ++m) labels.push_back("marker" + std::to_string(m));
  mocap::Take take = mocap::Take::empty("small", 120.0, labels, frames);
  take.residuals.assign(take.present.size(), 0.25F);
  take.cameras.assign(take.present.size(), 0x15);
  take.residual_step = 0.05F;
  take.events = {{"clap", 0.5}};
  for (int f = 0; f < frames; ++f) {
    for (int m = 0; m < markers; ++m) {
      if ((f + m) % 7 != 0) take.set(f, m, {100.0 * m + 0.5 * f, 50.0 - f, 10.0 * std::sin(0.3 * f + m)});
    }
  }
  return take;
}

}  // namespace vultus::fuzz
