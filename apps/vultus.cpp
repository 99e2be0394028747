#include "apps/commands.h"

int main(int argc, char** argv) {
  using namespace vultus::apps;
  CommandTable table;
  add_inspect(table);
  add_scan_clean(table);
  add_rig_databank(table);
  return table.run(argc, argv);
}
