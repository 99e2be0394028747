#include <gtest/gtest.h>

#include "apps/actor_report.h"
#include "apps/registration_report.h"

namespace vultus::apps {
namespace {

// A scan that no method could begin with is a failure among the poses, with the file that helps named after the pose.
TEST(UnregisteredReport, IsAFailureThatSaysWhyAndWhatToDo) {
  const nlohmann::json report = unregistered_report(
      "scream", "no place of the scan has the shape of a face; place landmarks by hand (landmarks/<pose>.json)");
  EXPECT_EQ(report.at("verdict"), "fail");
  EXPECT_NE(report.at("reason").get<std::string>().find("no place of the scan has the shape of a face"),
            std::string::npos);
  EXPECT_NE(report.at("reason").get<std::string>().find("landmarks/scream.json"), std::string::npos);
  ASSERT_EQ(report.at("reasons").size(), 1u);
  EXPECT_EQ(report.at("reasons")[0], report.at("reason"));
  const std::string page =
      actor_report_page("someone", {{"template", "head"}, {"method", "default"}, {"poses", {report}}});
  EXPECT_NE(page.find("0 passed, 0 to look at, 1 failed"), std::string::npos);
  EXPECT_NE(page.find("landmarks/scream.json"), std::string::npos);
}

}  // namespace
}  // namespace vultus::apps
