#include "apps/mocap_files.h"

#include <CLI/CLI.hpp>
#include <algorithm>

namespace vultus::apps {

void add_take_options(CLI::App& app, TakeArguments& arguments) {
  app.add_option("TAKE", arguments.take, "C3D, TRC or CSV (plain, Motive's or Vicon's)")->required()->type_name("FILE");
  app.add_option("--out", arguments.out, "C3D or TRC to write; what is missing stays missing")
      ->required()
      ->type_name("FILE");
  app.add_option("--unit", arguments.reading.unit, "Unit of the file: mm, cm, m or in (default: what the file says)");
  app.add_option("--up", arguments.reading.up_axis,
                 "Up axis of the file: x, y, z, -x, -y or -z (default: what the file says)");
  app.add_option("--rate", arguments.reading.rate_hz, "Frame rate, Hz (default: what the file says)")
      ->check(CLI::Range(0.1, 1e5));
}

mocap::Take read_step(const TakeArguments& arguments, Run& run) {
  run.input(arguments.take);
  mocap::Take take = mocap::read_take(arguments.take, arguments.reading);
  for (const std::string& line : take.decisions) run.progress().note(line);
  run.report()["decisions"] = take.decisions;
  return take;
}

void write_step(const TakeArguments& arguments, const mocap::Take& take, Run& run) {
  mocap::write_take(arguments.out, take);
  const auto missing = std::count(take.present.begin(), take.present.end(), std::uint8_t{0});
  run.numbers()["frames"] = take.frames();
  run.numbers()["markers"] = take.markers();
  run.numbers()["missing"] =
      take.present.empty() ? 0.0 : static_cast<double>(missing) / static_cast<double>(take.present.size());
  run.print(arguments.out.string());
}

}  // namespace vultus::apps
