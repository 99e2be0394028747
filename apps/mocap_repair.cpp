#include <CLI/CLI.hpp>

#include "apps/commands.h"
#include "apps/mocap_files.h"
#include "mocap/repeats.h"
#include "mocap/spikes.h"

namespace vultus::apps {
namespace {

struct Arguments {
  TakeArguments files;
  mocap::SpikeOptions spikes;
};

ExitCode repair(const Arguments& arguments, Run& run) {
  const mocap::Take raw = read_step(arguments.files, run);
  const auto repeats = mocap::find_repeats(raw);
  const mocap::Take measured = mocap::without(raw, repeats);
  const auto spikes = mocap::find_spikes(measured, arguments.spikes);
  run.print("what,marker,first,last,size_mm");
  nlohmann::json rows = nlohmann::json::array();
  const auto list = [&](const std::string& what, const std::string& marker, int first, int last, nlohmann::json size) {
    run.print_row({what, marker, first, last, size});
    rows.push_back({{"what", what}, {"marker", marker}, {"first", first}, {"last", last}});
    if (!size.is_null()) rows.back()["size_mm"] = size;
  };
  for (const mocap::Repeat& repeat : repeats) {
    const std::string marker = repeat.marker < 0 ? "" : raw.labels[static_cast<std::size_t>(repeat.marker)];
    list(mocap::name_of(repeat.kind), marker, repeat.first, repeat.last, {});
  }
  for (const mocap::Spike& spike : spikes) {
    list("spike", measured.labels[static_cast<std::size_t>(spike.marker)], spike.first, spike.last, spike.size);
  }
  run.report()["repairs"] = rows;
  run.numbers() = {{"repeats", repeats.size()}, {"spikes", spikes.size()}};
  write_step(arguments.files, mocap::without(measured, spikes), run);
  return ExitCode::ok;
}

}  // namespace

void add_mocap_repair(CommandTable& table) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App& app =
      table.add("mocap repair", "Repeated frames, markers that stand still and spikes taken out of a take, and listed",
                "vultus mocap repair raw.c3d --out repaired.c3d > repairs.csv\n"
                "Best after `mocap stabilize`: a spike is then small against the face's own motion.",
                {}, [arguments](Run& run) { return repair(*arguments, run); });
  add_take_options(app, arguments->files);
  app.add_option("--least", arguments->spikes.least_mm, "Smaller jumps are no spikes, mm")->capture_default_str();
  app.add_option("--factor", arguments->spikes.factor, "A spike is so many times the marker's usual scatter")
      ->capture_default_str();
  app.add_option("--longest", arguments->spikes.longest_seconds, "Longer jumps are no spikes, seconds (0 to 0.1)")
      ->capture_default_str();
}

}  // namespace vultus::apps
