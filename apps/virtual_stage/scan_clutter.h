#pragma once

#include "apps/virtual_stage/scanner.h"
#include "core/random.h"

namespace vultus::virtual_stage {

/// Adds what nobody wanted in a scan: strands rising from hair, bits of both shoulders, of the stand behind the head,
/// and flying points (tiny triangles). New vertices come last and have invalid `truth`.
void add_clutter(Scan& scan, const ScanSubject& subject, Random& random);

}  // namespace vultus::virtual_stage
