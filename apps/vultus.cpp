#include "apps/commands.h"

int main(int argc, char** argv) {
  using namespace vultus::apps;
  CommandTable table;
  add_demo(table);
  add_simulate(table);
  add_onboard(table);
  add_session(table);
  add_render(table);
  add_review(table);
  add_inspect(table);
  add_scan_clean(table);
  add_register(table);
  add_rig_databank(table);
  add_mocap_clean(table);
  add_mocap_convert(table);
  add_mocap_label(table);
  add_mocap_repair(table);
  add_mocap_stabilize(table);
  add_mocap_fill(table);
  add_mocap_filter(table);
  add_mocap_poses(table);
  add_bench_registration(table);
  add_bench_mocap(table);
  return table.run(argc, argv);
}
