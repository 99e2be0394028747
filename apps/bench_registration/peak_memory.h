#pragma once

namespace vultus::apps::bench {

/// Lets the process's peak of resident memory start anew from what it holds now (Linux: /proc/self/clear_refs). False
/// where the system does not allow it; the peak is then that of the whole run.
bool reset_peak_memory();
/// The peak since, bytes; 0 where the system does not tell.
double peak_memory();
/// What the process holds now, bytes; 0 where the system does not tell.
double resident_memory();

}  // namespace vultus::apps::bench
