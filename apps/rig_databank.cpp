#include <CLI/CLI.hpp>

#include "apps/commands.h"
#include "rig/databank.h"

namespace vultus::apps {
namespace {

struct Arguments {
  std::filesystem::path folder, out;
};

ExitCode import(const Arguments& arguments, Run& run) {
  for (const std::string& line :
       rig::import_ict_facekit(arguments.folder, arguments.out, run.progress(), run.force())) {
    run.progress().note(line);
  }
  const rig::Actor actor = rig::load_actor(arguments.out);
  run.numbers() = {{"poses", actor.poses.size()}, {"vertices", actor.topology->vertex_count()}};
  run.print(arguments.out.string());
  return ExitCode::ok;
}

}  // namespace

void add_rig_databank(CommandTable& table) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App& app = table.add("rig databank", "ICT-FaceKit's folder to a databank of expressions and a template",
                            "vultus rig databank ict-facekit --out databank\n"
                            "  vultus onboard capture --actor actor --template databank --databank databank",
                            {.force = true}, [arguments](Run& run) { return import(*arguments, run); });
  app.add_option("FOLDER", arguments->folder, "ICT-FaceKit's model folder")->required();
  app.add_option("--out", arguments->out,
                 "Databank folder to write: an actor folder with template.obj and template.json")
      ->required()
      ->type_name("FOLDER");
}

}  // namespace vultus::apps
