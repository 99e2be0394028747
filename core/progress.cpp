#include "core/progress.h"

#include "core/error.h"

namespace vultus {
namespace {

class SilentProgress final : public Progress {
 public:
  void begin(std::string_view, std::size_t) override {}
  void advance(std::size_t) override {}
  void note(std::string_view) override {}
  bool cancelled() const override { return false; }
};

}  // namespace

void Progress::check() const {
  if (cancelled()) throw Cancelled();
}

Progress& Progress::none() {
  static SilentProgress silent;
  return silent;
}

}  // namespace vultus
