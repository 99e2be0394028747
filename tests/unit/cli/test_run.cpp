#include <gtest/gtest.h>

#include "apps/command.h"

namespace vultus::apps {
namespace {

TEST(Run, RowsAreCsv) {
  Console console(true);
  apps::Run run(console, 1, false);
  testing::internal::CaptureStdout();
  run.print_row({"LIP 1", 3, 0.25, nullptr, R"(9 mm, "far")"});
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "LIP 1,3,0.25,,\"9 mm, \"\"far\"\"\"\n");
}

}  // namespace
}  // namespace vultus::apps
