#pragma once

#include <gtest/gtest.h>

#include <memory>

#include "core/error.h"
#include "register/face_finder.h"

namespace vultus::registration::test {

/// Tests that need dlib's model: loaded once for all of them, skipped where it is not installed.
class WithFinder : public testing::Test {
 protected:
  void SetUp() override {
    if (!finder) GTEST_SKIP() << "dlib's 68-point model is not installed (libdlib-data)";
  }
  static std::unique_ptr<FaceFinder> load() {
    try {
      return std::make_unique<FaceFinder>();
    } catch (const ToolError&) {
      return nullptr;
    }
  }
  inline static const std::unique_ptr<FaceFinder> finder = load();
};

}  // namespace vultus::registration::test
