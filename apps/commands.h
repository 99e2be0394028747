#pragma once

#include "apps/command.h"

namespace vultus::apps {

// One function a command, each in the source of its name.
void add_demo(CommandTable& table);
void add_simulate(CommandTable& table);
void add_onboard(CommandTable& table);
void add_session(CommandTable& table);
void add_render(CommandTable& table);
void add_review(CommandTable& table);
void add_inspect(CommandTable& table);
void add_scan_clean(CommandTable& table);
void add_register(CommandTable& table);
void add_rig_databank(CommandTable& table);
void add_mocap_clean(CommandTable& table);
void add_mocap_convert(CommandTable& table);
void add_mocap_label(CommandTable& table);
void add_mocap_repair(CommandTable& table);
void add_mocap_stabilize(CommandTable& table);
void add_mocap_fill(CommandTable& table);
void add_mocap_filter(CommandTable& table);
void add_mocap_poses(CommandTable& table);
void add_bench_registration(CommandTable& table);
void add_bench_mocap(CommandTable& table);

}  // namespace vultus::apps
