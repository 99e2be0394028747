#include "mocap/c3d.h"
#include "tests/fuzz/reader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  vultus::fuzz::check_reader([](const auto& file) { return vultus::mocap::read_c3d(file); }, data, size);
  return 0;
}

std::vector<std::string> vultus::fuzz::seeds() {
  const auto of = [](int frames, int markers) {
    return written([&](const auto& file) { mocap::write_c3d(file, small_take(frames, markers)); }, ".c3d");
  };
  std::vector<std::string> files = {of(6, 3), of(1, 1), of(2, 300)};
  // The same bytes as another processor would understand them: a wrong file, but one that leads into other branches.
  for (const char processor : {char(85), char(86)}) {
    files.push_back(files[0]);
    files.back()[515] = processor;
  }
  return files;
}
