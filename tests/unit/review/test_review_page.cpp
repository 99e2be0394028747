#include <cstdio>
#include <regex>

#include "apps/review_page.h"
#include "core/error.h"
#include "review_session.h"

namespace vultus::apps {
namespace {

using testing::ReviewFolder;

bool libraries_installed() {
  return fs::exists("/usr/share/javascript/dygraphs/dygraph.min.js") &&
         fs::exists("/usr/share/javascript/three/three.min.js");
}

TEST(ReviewPage, IsOneFileThatLoadsNothing) {
  if (!libraries_installed()) GTEST_SKIP() << "libjs-dygraphs and libjs-three are not installed";
  const ReviewFolder folder;
  const ReviewPage page = write_review(folder.session());
  const std::string text = read_file(page.file);
  EXPECT_EQ(page.bytes, text.size());
  EXPECT_EQ(page.pictures, 2);
  const std::regex loads(R"re(<(script|link|img|video|iframe)[^>]*(src|href)="(?!data:))re");
  EXPECT_FALSE(std::regex_search(text, loads));
  for (const char* mark : {"@STYLE@", "@LIBRARIES@", "@SCRIPTS@", "@DATA@", "@TITLE@"}) {
    EXPECT_EQ(text.find(mark), std::string::npos) << mark;
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(page.file.parent_path()), fs::directory_iterator{}), 1);
}

TEST(ReviewPage, SameSessionSameBytes) {
  if (!libraries_installed()) GTEST_SKIP() << "libjs-dygraphs and libjs-three are not installed";
  const ReviewFolder folder;
  const std::string first = read_file(write_review(folder.session()).file);
  EXPECT_EQ(read_file(write_review(folder.session()).file), first);
}

TEST(ReviewPage, NamesCannotBreakOut) {
  if (!libraries_installed()) GTEST_SKIP() << "libjs-dygraphs and libjs-three are not installed";
  const ReviewFolder folder("</script><b>@DATA@");
  const std::string text = read_file(write_review(folder.session()).file);
  // Three scripts of ours end; a name that broke out would end more.
  std::size_t ends = 0;
  for (std::size_t at = text.find("</script"); at != std::string::npos; at = text.find("</script", at + 1)) ++ends;
  EXPECT_EQ(ends, 3u);
}

TEST(ReviewPage, AMissingLibraryNamesItsPackage) {
  const ReviewFolder folder;
  ReviewOptions options;
  options.javascript = folder.session() / "nothing_here";
  try {
    write_review(folder.session(), options);
    FAIL();
  } catch (const ToolError& error) {
    EXPECT_NE(std::string(error.what()).find("apt install libjs-dygraphs"), std::string::npos) << error.what();
  }
  EXPECT_FALSE(fs::exists(folder.session() / "review" / "index.html"));
}

std::string output_of(const std::string& command) {
  std::string output;
  FILE* pipe = popen(command.c_str(), "r");
  char buffer[4096];
  while (pipe != nullptr && std::fgets(buffer, sizeof buffer, pipe) != nullptr) output += buffer;
  if (pipe != nullptr) pclose(pipe);
  return output;
}

TEST(ReviewPage, ABrowserShowsItWithoutErrors) {
  if (!libraries_installed() || !fs::exists("/usr/bin/chromium")) GTEST_SKIP() << "no chromium here";
  const ReviewFolder folder;
  const ReviewPage page = write_review(folder.session());
  const std::string command =
      "timeout 60 /usr/bin/chromium --headless --no-sandbox --disable-gpu --disable-background-networking "
      "--use-gl=angle --use-angle=swiftshader --enable-logging=stderr --v=0 --virtual-time-budget=2000 "
      "--user-data-dir=" +
      (folder.session() / "browser").string() + " --dump-dom file://" + page.file.string() + " 2>&1";
  const std::string output = output_of(command);
  EXPECT_EQ(output.find("Uncaught"), std::string::npos) << output.substr(output.find("Uncaught"), 300);
  for (const char* shown : {"Where to look", "lips not sealed", "Marker error", "Pose weights", "3 gaps in 3 markers",
                            "labels swapped back", "change of labels refused", "jig2 slips by 2.50 mm at 14"}) {
    // The data itself holds some of these words; what the page shows comes before it.
    const std::size_t at = output.find(shown);
    ASSERT_NE(at, std::string::npos) << shown;
    EXPECT_LT(at, output.find("id=\"data\"")) << shown;
  }
}

}  // namespace
}  // namespace vultus::apps
