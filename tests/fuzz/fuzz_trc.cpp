#include "mocap/trc.h"
#include "tests/fuzz/reader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  vultus::fuzz::check_reader([](const auto& file) { return vultus::mocap::read_trc(file); }, data, size);
  return 0;
}

std::vector<std::string> vultus::fuzz::seeds() {
  const auto of = [](int frames, int markers) {
    return written([&](const auto& file) { mocap::write_trc(file, small_take(frames, markers)); }, ".trc");
  };
  return {of(6, 3), of(1, 1), of(2, 40)};
}
