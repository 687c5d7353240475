// How far each layer of a tray reaches, which is what a PolyJet's time depends on.
#pragma once

#include <vector>

#include "model/mesh.h"

namespace packmerger {

// The axis-aligned box of matter and support in each layer (support to a cell of a grid of some
// 65,000), seen from above, mm. Empty (isEmpty()) where the layer holds neither.
using LayerExtents = std::vector<Eigen::AlignedBox2d>;

// Layers as slice_layers() cuts them. parts: closed meshes in tray coordinates, mm. support_angle:
// as support_volume_mm3() takes it.
LayerExtents layer_extents(const std::vector<const Mesh*>& parts, double layer_mm,
                           double support_angle);

}  // namespace packmerger
