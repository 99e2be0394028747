#include <CLI/CLI.hpp>
#include <algorithm>

#include "apps/commands.h"
#include "apps/mocap_files.h"
#include "mocap/layout_fit.h"
#include "mocap/template_labels.h"

namespace vultus::apps {
namespace {

struct Arguments {
  TakeArguments files;
  mocap::LabelOptions options;
  std::filesystem::path edits, apply, undo, labels_from;
};

mocap::Take applied(const Arguments& arguments, const mocap::Take& raw, Run& run) {
  mocap::LabelEdits edits;
  mocap::Take take;
  if (!arguments.apply.empty()) {
    run.input(arguments.apply);
    edits = mocap::read_edits(arguments.apply);
    take = mocap::apply_edits(raw, edits);
    for (const std::string& line : mocap::list_notes(edits)) run.progress().note(line);
  } else {
    mocap::Relabelled relabelled;
    if (arguments.labels_from.empty()) {
      relabelled = mocap::repair_labels(raw, arguments.options);
    } else {
      run.input(arguments.labels_from);
      const mocap::Take labelled = mocap::read_take(arguments.labels_from, arguments.files.reading);
      relabelled = mocap::label_from_layout(raw, mocap::marker_layout(labelled), arguments.options);
    }
    for (const std::string& line : relabelled.decisions) run.progress().note(line);
    for (const std::string& line : relabelled.warnings) run.warn(line);
    edits = std::move(relabelled.edits);
    take = std::move(relabelled.take);
  }
  run.print("what,first,last,moves,score,why");
  for (const mocap::LabelEdit& edit : edits.edits) {
    std::string moves;
    for (const mocap::LabelMove& move : edit.moves) {
      moves += (moves.empty() ? "" : " ") + move.from + ">" + (move.to.empty() ? "(dropped)" : move.to);
    }
    run.print_row({mocap::name_of(edit.kind) + (edit.applied ? "" : " (refused)"), edit.first(), edit.last(), moves,
                   edit.score, edit.why});
  }
  run.numbers()["edits"] = std::ranges::count_if(edits.edits, &mocap::LabelEdit::applied);
  if (!arguments.edits.empty()) mocap::write_edits(arguments.edits, edits);
  return take;
}

ExitCode label(const Arguments& arguments, Run& run) {
  const mocap::Take raw = read_step(arguments.files, run);
  if (arguments.undo.empty()) {
    const mocap::Take take = applied(arguments, raw, run);
    write_step(arguments.files, take, run);
    return ExitCode::ok;
  }
  run.input(arguments.undo);
  write_step(arguments.files, mocap::undo_edits(raw, mocap::read_edits(arguments.undo)), run);
  return ExitCode::ok;
}

}  // namespace

void add_mocap_label(CommandTable& table) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App& app =
      table.add("mocap label", "Wrong labels, fragments and phantoms found and repaired, each change listed",
                "vultus mocap label raw.c3d --out labelled.c3d --edits edits.json\n"
                "  vultus mocap label raw.c3d --apply edits.json --out labelled.c3d   (after editing by hand)\n"
                "  vultus mocap label labelled.c3d --undo edits.json --out raw.c3d",
                {}, [arguments](Run& run) { return label(*arguments, run); });
  add_take_options(app, arguments->files);
  app.add_option("--edits", arguments->edits,
                 "Write the changes; each may be refused there by hand (\"applied\": false)")
      ->type_name("FILE.json");
  auto* apply = app.add_option("--apply", arguments->apply, "Make these changes instead of looking for any")
                    ->type_name("FILE.json");
  auto* undo =
      app.add_option("--undo", arguments->undo, "Take these changes back")->type_name("FILE.json")->excludes(apply);
  app.add_option("--labels-from", arguments->labels_from,
                 "A labelled take or neutral layout of the same markers, for a take with fewer than eight labels")
      ->type_name("FILE")
      ->excludes(apply)
      ->excludes(undo);
  app.add_option("--phantom", arguments->options.phantom_mm, "Samples that fit no marker within this are phantoms, mm")
      ->capture_default_str();
}

}  // namespace vultus::apps
