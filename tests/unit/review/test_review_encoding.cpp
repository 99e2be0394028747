#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "apps/review_encoding.h"

namespace vultus::apps {
namespace {

TEST(ReviewEncoding, Base64OfRfc4648) {
  EXPECT_EQ(base64(std::string_view("")), "");
  EXPECT_EQ(base64(std::string_view("f")), "Zg==");
  EXPECT_EQ(base64(std::string_view("fo")), "Zm8=");
  EXPECT_EQ(base64(std::string_view("foo")), "Zm9v");
  EXPECT_EQ(base64(std::string_view("foobar")), "Zm9vYmFy");
  EXPECT_EQ(base64(std::string_view("\xff\xfe\x00", 3)), "//4A");
}

TEST(ReviewEncoding, ArraysAreLittleEndian) {
  const std::vector<std::uint16_t> values = {1, 256};
  EXPECT_EQ(base64(std::span<const std::uint16_t>(values)), base64(std::string_view("\x01\x00\x00\x01", 4)));
}

TEST(ReviewEncoding, QuantizedRoundsClampsAndKeepsNan) {
  const std::vector<float> values = {0.0F, 0.0014F, 0.0016F, -3.0F, 1e9F, std::nanf("")};
  EXPECT_EQ(quantized(values, 0.001), (std::vector<std::uint16_t>{0, 1, 2, 0, 65534, 65535}));
}

TEST(ReviewEncoding, NothingEndsAScriptEarly) {
  EXPECT_EQ(script_text("a = '</script>';"), "a = '<\\/script>';");
  EXPECT_EQ(script_text("'</SCRIPT>' '<!--'"), "'<\\/SCRIPT>' '<\\!--'");
  EXPECT_EQ(script_text("x.replace(/</g, '')"), "x.replace(/</g, '')");
  EXPECT_EQ(style_text("</style>"), "<\\/style>");
}

TEST(ReviewEncoding, HtmlTextHasNoMarkup) { EXPECT_EQ(html_text("a<b> & \"c\""), "a&lt;b&gt; &amp; &quot;c&quot;"); }

TEST(ReviewEncoding, JsonStaysTheSameJson) {
  const nlohmann::json json = {{"name", "</script><!-- <b> \\ \""}};
  const std::string text = json_text(json.dump());
  EXPECT_EQ(text.find('<'), std::string::npos);
  EXPECT_EQ(nlohmann::json::parse(text), json);
}

}  // namespace
}  // namespace vultus::apps
