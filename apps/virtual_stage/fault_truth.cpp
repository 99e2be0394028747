#include "apps/virtual_stage/fault_truth.h"

#include <nlohmann/json.hpp>

#include "core/array_io.h"
#include "core/files.h"
#include "core/named_values.h"

namespace vultus::virtual_stage {
namespace {

using nlohmann::json;

constexpr Named<Fault::Kind> kKinds[] = {{Fault::Kind::swap, "swap"},
                                         {Fault::Kind::phantom, "phantom"},
                                         {Fault::Kind::stray_phantom, "stray phantom"},
                                         {Fault::Kind::fragment, "fragment"},
                                         {Fault::Kind::spike, "spike"},
                                         {Fault::Kind::dropout, "dropout"},
                                         {Fault::Kind::held, "held"}};

json json_of(const Fault& fault, const mocap::Take& take) {
  const auto label = [&](int column) { return take.labels[static_cast<std::size_t>(column)]; };
  json entry = {{"kind", name_in(kKinds, fault.kind)}, {"first", fault.first}, {"last", fault.last}};
  if (fault.kind != Fault::Kind::held) {
    for (const int marker : fault.markers) entry["markers"].push_back(label(marker));
  }
  if (fault.column >= 0) entry["column"] = label(fault.column);
  if (fault.kind == Fault::Kind::spike) entry["size_mm"] = fault.size;
  return entry;
}

}  // namespace

FaultOptions usual_faults(std::uint64_t seed, double times) {
  FaultOptions options;
  options.seed = seed;
  options.swaps *= times;
  options.phantoms *= times;
  options.fragments *= times;
  options.spikes = 40.0 * times;
  options.dropouts = 20.0 * times;
  options.held = 10.0 * times;
  options.slip_mm = times > 0.0 ? 3.0 : 0.0;
  return options;
}

void write_fault_truth(const std::filesystem::path& folder, const RecordedTake& recorded, const FaultyTake& faulty) {
  json truth = {{"faults", json::array()}};
  for (const Fault& fault : faulty.faults) truth["faults"].push_back(json_of(fault, faulty.take));
  if (faulty.slipped_marker >= 0) {
    truth["slip"] = {{"marker", faulty.take.labels[static_cast<std::size_t>(faulty.slipped_marker)]},
                     {"first", faulty.slip_first},
                     {"last", faulty.slip_last}};
  }
  write_json(folder / "faults.json", truth);
  Array owners;
  owners.shape = {static_cast<std::size_t>(faulty.take.frames()), faulty.take.labels.size()};
  owners.values.assign(faulty.owners.begin(), faulty.owners.end());
  write_npy(folder / "owners.npy", owners);
  mocap::write_take(folder / "recorded.c3d", recorded.take);
}

}  // namespace vultus::virtual_stage
