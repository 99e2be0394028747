#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "mocap/take.h"

namespace vultus::fuzz {

using Read = std::function<mocap::Take(const std::filesystem::path&)>;

/// Hands the bytes to a reader as a file that lives in memory. An `InputError` is a good answer; so is a take that
/// keeps its promises. Anything else stops the process: a take whose arrays disagree, a present sample that is not
/// finite, more samples than bytes, or one allocation beyond a mebibyte and 64 times the input.
void check_reader(const Read& read, const std::uint8_t* data, std::size_t size);

/// Whole small files of the target's kind, where the driver's mutations start. Every target defines it.
std::vector<std::string> seeds();

/// The same for a target that writes takes: a file's bytes as `write` leaves them.
std::string written(const std::function<void(const std::filesystem::path&)>& write, const std::string& extension);

/// A take with holes, residuals, camera masks and events.
mocap::Take small_take(int frames, int markers);

}  // namespace vultus::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
