#include <CLI/CLI.hpp>

#include "apps/commands.h"
#include "apps/mocap_files.h"
#include "mocap/clean.h"

namespace vultus::apps {
namespace {

struct Arguments {
  TakeArguments files;
  mocap::FillOptions options;
};

const std::vector<std::pair<std::string, mocap::GapMethod>> kMethods = {{"automatic", mocap::GapMethod::automatic},
                                                                        {"low-rank", mocap::GapMethod::low_rank},
                                                                        {"rigid-group", mocap::GapMethod::rigid_group},
                                                                        {"spline", mocap::GapMethod::spline}};

ExitCode fill(const Arguments& arguments, Run& run) {
  mocap::FillOptions options = arguments.options;
  options.seed = run.seed();
  const mocap::Filled filled = mocap::fill_gaps(read_step(arguments.files, run), options);
  for (const std::string& line : filled.decisions) run.progress().note(line);
  run.print("marker,first,last,method,expected_error_mm");
  std::size_t holes = 0;
  for (const mocap::Gap& gap : filled.gaps) {
    const bool hole = gap.method == mocap::Origin::missing;
    holes += hole;
    run.print_row({filled.take.labels[static_cast<std::size_t>(gap.marker)], gap.first, gap.last,
                   hole ? "hole" : mocap::name_of(gap.method),
                   hole ? nlohmann::json() : nlohmann::json(gap.expected_error)});
  }
  run.numbers() = {{"gaps", filled.gaps.size()}, {"holes", holes}};
  write_step(arguments.files, filled.take, run);
  return ExitCode::ok;
}

}  // namespace

void add_mocap_fill(CommandTable& table) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App& app = table.add("mocap fill", "Gaps of a stabilized take filled, each listed with its expected error",
                            "vultus mocap fill head.c3d --out filled.c3d > gaps.csv\n"
                            "Gaps that cannot be filled within --hole-above stay holes.",
                            {.seed = true}, [arguments](Run& run) { return fill(*arguments, run); });
  add_take_options(app, arguments->files);
  add_choice(app, "--method", arguments->options.method,
             "automatic: for each length of gap what does best on this take", kMethods);
  app.add_option("--spline", arguments->options.spline_seconds, "Splines bridge gaps up to this long, seconds")
      ->capture_default_str();
  app.add_option("--hole-above", arguments->options.hole_above_mm,
                 "Leave gaps with a larger expected error as holes, mm")
      ->capture_default_str();
}

}  // namespace vultus::apps
