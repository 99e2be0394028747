#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

namespace vultus::apps {

/// Bytes that can be had without swapping (MemAvailable); 0 where the system does not tell.
std::uint64_t available_memory();

/// What cleaning and registering a scan takes at its peak, judged by its file alone: triangles told by the header of a
/// PLY, or by the size of an OBJ or STL. For a file that cannot be read, what the smallest scan takes.
std::uint64_t memory_for_scan(const std::filesystem::path& scan);

/// How many items of these costs run at once at most within `budget` bytes: the dearest side by side.
std::size_t most_at_once(std::vector<std::uint64_t> costs, std::uint64_t budget, std::size_t threads);

/// Runs `work(i)` for every i, as many at once as `threads` and the budget allow, in the order of i; an item dearer
/// than the budget runs alone. When one throws, no further item starts, and the error of the lowest i comes through.
void run_within(std::uint64_t budget, const std::vector<std::uint64_t>& costs, std::size_t threads,
                const std::function<void(std::size_t)>& work);

}  // namespace vultus::apps
