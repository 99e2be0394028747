#pragma once

#include "core/image.h"
#include "register/registered.h"
#include "scan/clean.h"

namespace vultus::apps {

/// What to judge a registration by at a glance, from the front and from a side: the scan as it was cleaned, with what
/// was taken out in red and what was invented in blue; the result; the result in the colours of its distance to the
/// scan, up to 1 mm (grey: no data). Four columns (the scan close and with all around it), two rows; linear RGB.
Image pose_picture(const scan::CleanScan& scan, const registration::Registered& registered);

}  // namespace vultus::apps
