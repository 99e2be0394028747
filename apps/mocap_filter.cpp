#include <CLI/CLI.hpp>

#include "apps/commands.h"
#include "apps/mocap_files.h"
#include "mocap/filter.h"

namespace vultus::apps {
namespace {

struct Arguments {
  TakeArguments files;
  mocap::FilterOptions options;
};

const std::vector<std::pair<std::string, mocap::Smoothing>> kMethods = {{"butterworth", mocap::Smoothing::butterworth},
                                                                        {"gaussian", mocap::Smoothing::gaussian},
                                                                        {"three-frame", mocap::Smoothing::three_frame}};

ExitCode filter(const Arguments& arguments, Run& run) {
  arguments.options.validate();
  write_step(arguments.files, mocap::smoothed(read_step(arguments.files, run), arguments.options), run);
  return ExitCode::ok;
}

}  // namespace

void add_mocap_filter(CommandTable& table) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App& app = table.add("mocap filter", "A take smoothed over time, never across a hole",
                            "vultus mocap filter filled.c3d --cutoff 10 --out smooth.c3d\n"
                            "  vultus mocap filter filled.c3d --method three-frame --out smooth.c3d",
                            {}, [arguments](Run& run) { return filter(*arguments, run); });
  add_take_options(app, arguments->files);
  add_choice(app, "--method", arguments->options.smoothing,
             "butterworth: low pass without delay; gaussian; three-frame: mean with both neighbours (Zhu 2006 §6.1)",
             kMethods);
  app.add_option("--cutoff", arguments->options.cutoff_hz, "Butterworth: frequency of half power, Hz")
      ->capture_default_str();
  app.add_option("--sigma", arguments->options.sigma_seconds, "Gaussian: deviation, seconds")->capture_default_str();
}

}  // namespace vultus::apps
