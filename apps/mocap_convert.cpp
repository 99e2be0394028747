#include <CLI/CLI.hpp>

#include "apps/commands.h"
#include "apps/mocap_files.h"

namespace vultus::apps {

void add_mocap_convert(CommandTable& table) {
  auto arguments = std::make_shared<TakeArguments>();
  CLI::App& app = table.add("mocap convert", "A take from one file format to another, in mm with +y up",
                            "vultus mocap convert export.csv --out take.c3d\n"
                            "  vultus mocap convert old.c3d --unit cm --up z --out take.trc",
                            {}, [arguments](Run& run) {
                              write_step(*arguments, read_step(*arguments, run), run);
                              return ExitCode::ok;
                            });
  add_take_options(app, *arguments);
}

}  // namespace vultus::apps
