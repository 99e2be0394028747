#include "apps/bench_registration/peak_memory.h"

#include <fstream>
#include <string>

namespace vultus::apps::bench {
namespace {

// "VmHWM:   123456 kB" in /proc/self/status.
double status_bytes(const std::string& field) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with(field + ":")) return 1024.0 * std::stod(line.substr(field.size() + 1));
  return 0.0;
}

}  // namespace

bool reset_peak_memory() {
  std::ofstream clear("/proc/self/clear_refs");
  return static_cast<bool>(clear << "5" << std::flush);
}

double peak_memory() { return status_bytes("VmHWM"); }
double resident_memory() { return status_bytes("VmRSS"); }

}  // namespace vultus::apps::bench
