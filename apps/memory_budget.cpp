#include "apps/memory_budget.h"

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <fstream>
#include <mutex>
#include <sstream>
#include <string>
#include <thread>

namespace vultus::apps {
namespace {

namespace fs = std::filesystem;

// Triangles of a PLY by its header; 0 without one.
std::uint64_t ply_triangles(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string line;
  for (int lines = 0; lines < 1000 && std::getline(in, line); ++lines) {
    std::istringstream words(line);
    std::string element, name;
    std::uint64_t count = 0;
    if (words >> element >> name >> count && element == "element" && name == "face") return count;
    if (line.starts_with("end_header")) break;
  }
  return 0;
}

std::uint64_t triangles_in(const fs::path& file) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(file, error);
  if (error) return 0;
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  if (extension == ".ply") return ply_triangles(file);
  return size / (extension == ".stl" ? 50 : 35);  // a binary record; the shortest lines of an OBJ
}

// Whose turn it is, and what is left of the budget.
class Queue {
 public:
  Queue(std::uint64_t budget, const std::vector<std::uint64_t>& costs) : budget_(budget), costs_(costs) {}

  // Blocks until the next item fits; false when there is none.
  bool take(std::size_t& item) {
    std::unique_lock lock(mutex_);
    ready_.wait(lock,
                [&] { return next_ == costs_.size() || error_ || running_ == 0 || used_ + costs_[next_] <= budget_; });
    if (next_ == costs_.size() || error_) return false;
    item = next_++;
    used_ += costs_[item];
    ++running_;
    ready_.notify_all();
    return true;
  }
  void give_back(std::size_t item, std::exception_ptr error) {
    const std::scoped_lock lock(mutex_);
    used_ -= costs_[item];
    --running_;
    if (error && (!error_ || item < failed_)) {
      error_ = error;
      failed_ = item;
    }
    ready_.notify_all();
  }
  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  const std::uint64_t budget_;
  const std::vector<std::uint64_t>& costs_;
  std::mutex mutex_;
  std::condition_variable ready_;
  std::size_t next_ = 0, running_ = 0, failed_ = 0;
  std::uint64_t used_ = 0;
  std::exception_ptr error_;
};

}  // namespace

std::uint64_t available_memory() {
  std::ifstream in("/proc/meminfo");
  std::string name;
  std::uint64_t kilobytes = 0;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    if (words >> name >> kilobytes && name == "MemAvailable:") return kilobytes * 1024;
  }
  return 0;
}

std::uint64_t memory_for_scan(const fs::path& scan) {
  // Measured on scans of 0.5 and 8.5 million triangles: 430 bytes a triangle at the peak, most of it in cleaning.
  constexpr std::uint64_t fixed = 250'000'000, for_triangle = 600;
  return fixed + for_triangle * triangles_in(scan);
}

std::size_t most_at_once(std::vector<std::uint64_t> costs, std::uint64_t budget, std::size_t threads) {
  std::sort(costs.rbegin(), costs.rend());
  std::uint64_t used = 0;
  std::size_t count = 0;
  for (const std::uint64_t cost : costs) {
    used += cost;
    if (used > budget || count == threads) break;
    ++count;
  }
  return std::max<std::size_t>(1, count);
}

void run_within(std::uint64_t budget, const std::vector<std::uint64_t>& costs, std::size_t threads,
                const std::function<void(std::size_t)>& work) {
  Queue queue(budget, costs);
  const auto serve = [&] {
    for (std::size_t item = 0; queue.take(item);) {
      std::exception_ptr error;
      try {
        work(item);
      } catch (...) {
        error = std::current_exception();
      }
      queue.give_back(item, error);
    }
  };
  {
    // Threads of their own: tasks of one pool that wait for memory could wait for one another.
    std::vector<std::jthread> helpers;
    for (std::size_t k = 1; k < std::min(threads, costs.size()); ++k) helpers.emplace_back(serve);
    serve();
  }
  queue.rethrow();
}

}  // namespace vultus::apps
