#include <CLI/CLI.hpp>

#include "apps/commands.h"
#include "apps/review_page.h"

namespace vultus::apps {
namespace {

struct Arguments {
  std::filesystem::path session;
  ReviewOptions options;
};

ExitCode review(const Arguments& arguments, Run& run) {
  run.input(arguments.session / "session.json");
  const ReviewPage page = write_review(arguments.session, arguments.options, run.progress());
  run.numbers() = {
      {"bytes", page.bytes}, {"takes", page.takes}, {"pictures", page.pictures}, {"findings", page.findings}};
  constexpr std::size_t kLargePage = 30U << 20;
  if (page.bytes > kLargePage) run.warn("the page is larger than 30 MB; fewer --pictures make it smaller");
  run.print(page.file.string());
  return ExitCode::ok;
}

}  // namespace

void add_review(CommandTable& table) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App& app = table.add("review", "A session to one self-contained page: SESSION/review/index.html",
                            "vultus review session", {}, [arguments](Run& run) { return review(*arguments, run); });
  app.add_option("SESSION", arguments->session, "Session folder, as `vultus session` writes it")->required();
  app.add_option("--pictures", arguments->options.pictures.most,
                 "Rendered frames inlined for each take and mode at most")
      ->check(CLI::Range(1, 2000))
      ->capture_default_str();
  app.add_option("--picture-width", arguments->options.pictures.width, "Width of inlined pictures, pixels")
      ->check(CLI::Range(32, 4096))
      ->capture_default_str();
}

}  // namespace vultus::apps
