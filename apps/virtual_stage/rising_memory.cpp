#include "apps/virtual_stage/rising_memory.h"

#include <sys/mman.h>

#include <new>

namespace vultus::virtual_stage {
namespace {

thread_local RisingMemory* innermost = nullptr;

}  // namespace

RisingMemory::RisingMemory(std::size_t most_bytes) : outer_(innermost) {
  void* region = mmap(nullptr, most_bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (region == MAP_FAILED) throw std::bad_alloc();
  begin_ = next_ = static_cast<std::byte*>(region);
  end_ = begin_ + most_bytes;
  innermost = this;
}

RisingMemory::~RisingMemory() {
  innermost = outer_;
  munmap(begin_, static_cast<std::size_t>(end_ - begin_));
}

void* RisingMemory::take(std::size_t bytes, std::size_t alignment) {
  RisingMemory* memory = innermost;
  if (memory == nullptr) throw std::bad_alloc();
  const std::size_t used =
      (static_cast<std::size_t>(memory->next_ - memory->begin_) + alignment - 1) / alignment * alignment;
  if (bytes > static_cast<std::size_t>(memory->end_ - memory->begin_) - used) throw std::bad_alloc();
  memory->next_ = memory->begin_ + used + bytes;
  return memory->begin_ + used;
}

}  // namespace vultus::virtual_stage
