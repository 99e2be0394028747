#pragma once

#include "core/camera.h"
#include "core/mesh.h"

namespace vultus::render {

struct PortraitOptions {
  int width = 512, height = 512;  ///< pixels, 1 to 16384
  double azimuth = 0.0;           ///< radians from the front, positive towards the subject's left (+x)
  double elevation = 0.0;         ///< radians above the face
  double margin = 1.5;            ///< picture over face size, > 0: 1 touches the frame

  void validate() const;  ///< throws `UsageError`
};

/// Camera of a head-and-shoulders portrait: a long lens (16 degrees high) that frames the vertex set "face_narrow"
/// (else "face", else the whole mesh), the face looking along +z with +y up. `positions`: vertex_count×3, mm.
Camera portrait_camera(const Topology& topology, const Points& positions, const PortraitOptions& options = {});

}  // namespace vultus::render
