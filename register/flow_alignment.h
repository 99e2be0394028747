#pragma once

#include <vector>

#include "core/transform.h"
#include "register/appearance.h"
#include "register/graph_fit.h"

namespace vultus::registration {

/// A registered surface and the scan it was registered to.
struct Look {
  const Points& positions;  ///< of the topology, in the scan's frame, mm
  const Appearance& scan;
};

struct FlowOptions {
  int pixels = 420;              ///< of each picture
  double farthest = 9.0;         ///< mm: flows beyond are no skin movement left over from fitting
  double agreement = 1.0;        ///< pixels between a flow and the flow back
  double depth_tolerance = 3.0;  ///< mm between fit and scan beyond which a pixel is not skin (mouth, holes)
};

/// Where vertices of a fitted pose belong on the scan, told by optical flow: from several sides the fit is pictured
/// with what the neutral's scan shows at each place of the skin, the scan with what it shows itself, and the dense
/// inverse search flow (Kroeger et al. 2016, OpenCV) between both moves each vertex along the scan (Liu §5 aligns
/// texture maps by flow in the same spirit). Terms weigh by agreement of both directions and by contrast, up to 1.
/// `scan_from_face` turns face axes into the scan's.
std::vector<PointTerm> flow_targets(const Topology& topology, const std::vector<int>& vertices, const Look& neutral,
                                    const Look& pose, const Similarity& scan_from_face,
                                    const FlowOptions& options = {});

}  // namespace vultus::registration
