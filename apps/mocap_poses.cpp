#include <CLI/CLI.hpp>

#include "apps/commands.h"
#include "mocap/clean.h"
#include "mocap/key_poses.h"

namespace vultus::apps {
namespace {

struct Arguments {
  std::filesystem::path take, list, samples, out;
  std::vector<std::string> poses;
  mocap::HoldOptions holds;
};

ExitCode poses(const Arguments& arguments, Run& run) {
  if (arguments.poses.empty() == arguments.list.empty()) {
    throw UsageError("give the poses in the order of their performance (--poses), or a list of frames (--list)");
  }
  run.input(arguments.take);
  mocap::Take take = mocap::read_take(arguments.take);
  if (!arguments.samples.empty()) {
    run.input(arguments.samples);
    take.file_frames = mocap::read_samples(arguments.samples).file_frames;
    if (!take.file_frames.empty() && take.file_frames.size() != static_cast<std::size_t>(take.frames()))
      throw InputError(arguments.samples, "is of a take with " + std::to_string(take.file_frames.size()) + " frames; " +
                                              arguments.take.string() + " has " + std::to_string(take.frames()));
  }
  const mocap::KeyPoses found = arguments.list.empty() ? mocap::find_key_poses(take, arguments.poses, arguments.holds)
                                                       : mocap::key_poses(take, arguments.list);
  for (const std::string& line : found.decisions) run.progress().note(line);
  run.print("pose,first,last,spread_mm,score");
  for (std::size_t i = 0; i < found.poses.size(); ++i) {
    run.print_row(
        {found.poses[i], found.file_holds[i].first, found.file_holds[i].second, found.spread[i], found.scores[i]});
  }
  if (!arguments.out.empty()) mocap::write_training(arguments.out, arguments.take.stem().string(), found);
  run.numbers() = {{"poses", found.poses.size()}};
  return ExitCode::ok;
}

}  // namespace

void add_mocap_poses(CommandTable& table) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App& app = table.add("mocap poses", "The frames of a clean training take that show the database's poses",
                            "vultus mocap poses clean.c3d --poses neutral smile frown --out training.json\n"
                            "  vultus mocap poses clean.c3d --list training.json   (checks a list by hand)",
                            {}, [arguments](Run& run) { return poses(*arguments, run); });
  app.add_option("TAKE", arguments->take, "Clean take, as `vultus mocap clean` writes it")
      ->required()
      ->type_name("FILE");
  app.add_option("--poses", arguments->poses, "Names in the order in which they were performed")->type_name("NAME…");
  app.add_option("--list", arguments->list, "Frames by hand: training.json")->type_name("FILE.json");
  app.add_option(
         "--samples", arguments->samples,
         "What `vultus mocap clean` wrote beside TAKE: frames then count as in the captured file, which cleaning "
         "may have shortened")
      ->type_name("FILE.json");
  app.add_option("--out", arguments->out, "Write the list that `vultus session` reads")->type_name("FILE.json");
  app.add_option("--least-hold", arguments->holds.least_seconds, "Shorter rests of the face are no holds, seconds")
      ->capture_default_str();
}

}  // namespace vultus::apps
