// The scene that the web page shows: small enough for a slow network, and near enough for a screen.
#pragma once

#include <string>
#include <vector>

#include "model/mesh.h"
#include "offscreen/offscreen.h"

namespace packmerger {

struct PagePart {
  int id = 0;
  const Mesh* surface = nullptr;         // model coordinates, mm
  Pose on_tray = Pose::Identity();       // model → tray, a rotation and a translation
  Vec3 aside_on_tray_mm = Vec3::Zero();  // on top of that
  Vec3 aside_in_model_mm = Vec3::Zero();
  Colour colour;
};

// A GLB with two scenes of the same meshes, 0 the trays and 1 the models put together, in the axes
// and the unit of gltf.h. Each node's extras hold "part", its id. Over all parts there are about
// 40,000 triangles at most (meshoptimizer), with coordinates of 16 bits and normals of 8
// (KHR_mesh_quantization). Throws Error{kInternal} when tinygltf fails.
std::string page_glb(const std::vector<PagePart>& parts);

}  // namespace packmerger
