#include <CLI/CLI.hpp>
#include <algorithm>

#include "apps/commands.h"
#include "mocap/clean.h"
#include "mocap/layout_fit.h"

namespace vultus::apps {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  fs::path take, out, samples, labels, labels_from;
  bool keep_labels = false, no_slips = false;
  mocap::ReadOptions reading;
  mocap::CleanOptions options;
};

ExitCode clean(const Arguments& arguments, Run& run) {
  run.input(arguments.take);
  mocap::CleanOptions options = arguments.options;
  options.gaps.seed = run.seed();
  options.repair_labels = !arguments.keep_labels;
  options.head.find_slips = !arguments.no_slips;
  if (!arguments.labels_from.empty()) {
    run.input(arguments.labels_from);
    if (arguments.labels_from.extension() == ".json") {
      options.label_edits = mocap::read_edits(arguments.labels_from);
    } else {
      options.layout = mocap::marker_layout(mocap::read_take(arguments.labels_from, arguments.reading));
    }
  }
  const mocap::Cleaned cleaned =
      mocap::clean(mocap::read_take(arguments.take, arguments.reading), options, run.progress());
  for (const std::string& line : cleaned.report.decisions) run.progress().note(line);
  for (const std::string& line : cleaned.report.warnings) run.warn(line);
  mocap::write_take(arguments.out, cleaned.take);
  if (!arguments.samples.empty()) mocap::write_samples(arguments.samples, cleaned.report);
  if (!arguments.labels.empty()) mocap::write_edits(arguments.labels, cleaned.label_edits);
  run.numbers() = {{"frames", cleaned.take.frames()},
                   {"markers", cleaned.take.markers()},
                   {"label_edits", std::ranges::count_if(cleaned.label_edits.edits, &mocap::LabelEdit::applied)},
                   {"gaps", cleaned.report.gaps.size()},
                   {"spikes", cleaned.report.spikes.size()},
                   {"head_method", cleaned.report.head_method},
                   {"head_rms_mm", cleaned.report.head_rms}};
  run.print(arguments.out.string());
  return ExitCode::ok;
}

}  // namespace

void add_mocap_clean(CommandTable& table) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App& app = table.add("mocap clean", "Raw take to a stabilized, filled and smoothed one",
                            "vultus mocap clean raw.c3d --out clean.c3d --samples samples.json", {.seed = true},
                            [arguments](Run& run) { return clean(*arguments, run); });
  app.add_option("TAKE", arguments->take, "C3D, TRC or CSV")->required()->type_name("FILE");
  app.add_option("--out", arguments->out, "C3D or TRC to write")->required()->type_name("FILE");
  app.add_option("--samples", arguments->samples, "Write how each filled sample came to be")->type_name("FILE.json");
  CLI::Option* labels =
      app.add_option("--labels", arguments->labels, "Write every change of labels")->type_name("FILE.json");
  CLI::Option* from = app.add_option("--labels-from", arguments->labels_from,
                                     "Such a list, looked through by hand (\"applied\": false refuses a change): "
                                     "applied instead of a search; or a labelled take (C3D, TRC, CSV) or neutral "
                                     "layout of the same markers, for a take that has fewer than eight labels")
                          ->type_name("FILE");
  app.add_flag("--keep-labels", arguments->keep_labels, "Swaps, fragments and phantoms are left as they are")
      ->excludes(labels)
      ->excludes(from);
  app.add_flag("--no-slips", arguments->no_slips, "Jig markers are taken to stay where they are on the head");
  app.add_option("--jig", arguments->options.head.jig,
                 "Labels of the head's markers (default: those that look like a jig's)")
      ->type_name("LABEL…");
  app.add_option("--unit", arguments->reading.unit, "Unit of the file: mm, cm, m or in (default: what the file says)");
  app.add_option("--up", arguments->reading.up_axis,
                 "Up axis of the file: x, y, z, -x, -y or -z (default: what the file says)");
  app.add_option("--cutoff", arguments->options.filter.cutoff_hz, "Low-pass frequency, Hz")->capture_default_str();
}

}  // namespace vultus::apps
