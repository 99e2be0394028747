#include <CLI/CLI.hpp>

#include "apps/commands.h"
#include "apps/registration_report.h"
#include "apps/scan_file.h"
#include "core/files.h"
#include "core/mesh_io.h"
#include "register/consistent.h"
#include "register/template_file.h"
#include "register/template_head.h"

namespace vultus::apps {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  fs::path scan, out, template_path, landmarks;
  std::string method = "default", energy_solver = "ceres", landmarks_by = "automatic";
  scan::CleanOptions cleaning;
};

ExitCode register_scan(const Arguments& arguments, Run& run) {
  run.input(arguments.scan);
  registration::RegisterOptions options = registration::register_options(arguments.method, arguments.energy_solver);
  options.landmarks_by = registration::landmark_finder_named(arguments.landmarks_by);
  const registration::Registration registration(arguments.template_path.empty()
                                                    ? registration::template_head()
                                                    : registration::read_template(arguments.template_path),
                                                options);
  const scan::CleanScan cleaned = clean_scan_file(arguments.scan, arguments.cleaning, run.progress());
  std::optional<registration::ScanLandmarks> landmarks;
  if (!arguments.landmarks.empty()) {
    landmarks = registration::read_landmarks(arguments.landmarks, cleaned.report.units.mm_per_unit);
  }
  const registration::Registered registered = registration.neutral(cleaned, landmarks, run.progress());
  run.numbers() = pose_report({"neutral", {}, arguments.scan, arguments.landmarks}, registered, cleaned.report.lines());
  for (const auto& line : run.numbers().at("decisions")) run.progress().note(line.get<std::string>());
  run.progress().note(summary_line(run.numbers()));
  write_obj(arguments.out, registered.mesh);
  run.print(arguments.out.string());
  return registered.quality.verdict == registration::Verdict::fail ? ExitCode::below_quality : ExitCode::ok;
}

}  // namespace

void add_register(CommandTable& table) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App& app =
      table.add("register", "One neutral scan to the template's topology", "vultus register scan.ply --out head.obj",
                {}, [arguments](Run& run) { return register_scan(*arguments, run); });
  app.add_option("SCAN", arguments->scan, "OBJ, PLY or STL")->required()->type_name("FILE");
  app.add_option("--out", arguments->out, "OBJ to write, face frame, mm")->required()->type_name("FILE");
  app.add_option("--template", arguments->template_path, "template.obj or its folder (default: the built-in head)")
      ->type_name("PATH");
  app.add_option("--landmarks", arguments->landmarks, "Points placed by hand (default: found)")->type_name("FILE.json");
  app.add_option("--mm-per-unit", arguments->cleaning.mm_per_unit,
                 "Millimetres in one unit of the scan (0: from its size)");
  add_choice(app, "--landmarks-by", arguments->landmarks_by, "What finds the points that are not placed by hand",
             registration::landmark_finder_names());
  add_choice(app, "--method", arguments->method, "How the scan is brought to the template",
             registration::method_names());
  add_choice(app, "--energy-solver", arguments->energy_solver, "What minimizes the energy of --method sanchez",
             registration::energy_solver_names());
}

}  // namespace vultus::apps
