#include <gtest/gtest.h>

#include "apps/actor_report.h"

namespace vultus::apps {
namespace {

TEST(ActorReport, TellsVerdictsReasonsAndPicturesWorstFirst) {
  const nlohmann::json report = {
      {"template", "head"},
      {"method", "default"},
      {"warnings", {"left out: scream: no face found"}},
      {"poses",
       {{{"pose", "neutral"}, {"verdict", "pass"}, {"reason", ""}, {"picture", "report/neutral.png"}},
        {{"pose", "smile"},
         {"verdict", "warn"},
         {"reason", "12 triangles folded over"},
         {"reasons", {"12 triangles folded over"}},
         {"regions", {{"under_chin", {{"mean", 0.25}, {"p95", 0.5}, {"coverage", 0.5}, {"flipped", 12}}}}},
         {"seals", {{{"name", "lips"}, {"mesh_mm", 0.4}, {"scan_mm", nullptr}}}},
         {"cleaning", {"3 spikes removed"}}},
        {{"pose", "a<b"}, {"verdict", "fail"}, {"reason", "inside & out"}}}}};
  const std::string page = actor_report_page("someone", report);
  EXPECT_NE(page.find("1 passed, 1 to look at, 1 failed"), std::string::npos);
  EXPECT_LT(page.find("inside &amp; out"), page.find("12 triangles folded over"));  // the failure comes first
  EXPECT_NE(page.find("src=\"neutral.png\""), std::string::npos);
  EXPECT_NE(page.find("<td>under chin</td><td>0.25</td><td>0.50</td><td>50 %</td><td>12</td>"), std::string::npos);
  EXPECT_NE(page.find("lips open by 0.4 mm, the scan does not tell"), std::string::npos);
  EXPECT_NE(page.find("3 spikes removed"), std::string::npos);
  EXPECT_NE(page.find("left out: scream"), std::string::npos);
  EXPECT_EQ(page.find("a<b"), std::string::npos);
}

}  // namespace
}  // namespace vultus::apps
