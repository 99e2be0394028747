#pragma once

#include <cstddef>

namespace vultus::virtual_stage {

/// Memory whose addresses rise with every request on the calling thread, for a library that orders by address: with it,
/// the same work gives the same order in every run. Nothing is given back before `RisingMemory` ends.
class RisingMemory {
 public:
  explicit RisingMemory(std::size_t most_bytes);  ///< address space, not memory; throws `std::bad_alloc`
  ~RisingMemory();
  RisingMemory(const RisingMemory&) = delete;
  RisingMemory& operator=(const RisingMemory&) = delete;

  /// From the innermost `RisingMemory` of this thread; throws `std::bad_alloc` when there is none or it is used up.
  static void* take(std::size_t bytes, std::size_t alignment);

 private:
  std::byte *begin_, *next_, *end_;
  RisingMemory* outer_;
};

template <class T>
struct RisingAllocator {
  using value_type = T;
  RisingAllocator() = default;
  template <class U>
  RisingAllocator(const RisingAllocator<U>&) {}
  T* allocate(std::size_t count) { return static_cast<T*>(RisingMemory::take(count * sizeof(T), alignof(T))); }
  void deallocate(T*, std::size_t) {}
  template <class U>
  bool operator==(const RisingAllocator<U>&) const {
    return true;
  }
};

}  // namespace vultus::virtual_stage
