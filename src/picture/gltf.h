// glTF 2.0 scenes as binary GLB, for the web page and any viewer.
#pragma once

#include <string>
#include <vector>

#include "model/mesh.h"
#include "offscreen/offscreen.h"

namespace packmerger {

struct GltfPart {
  std::string name;
  const Mesh* surface = nullptr;
  Pose pose = Pose::Identity();  // surface → scene, mm, z up
  Colour colour;
  Vec3 aside_mm = Vec3::Zero();  // the node's translation on top of that, in the scene's axes
};

// One node and one mesh per part. Vertices are in metres with y up, as glTF demands: (x, y, z) of
// the scene becomes (x, z, −y) / 1000. A normal is that of the faces around the corner that turn
// less than 40°. Valid by the Khronos glTF validator; the same parts give the same bytes. Throws
// Error{kInternal} when tinygltf fails.
std::string glb_bytes(const std::vector<GltfPart>& parts);

}  // namespace packmerger
