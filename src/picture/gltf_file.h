// What the glTF scenes are written with. For this folder only.
#pragma once

#include <string>

#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#include <tiny_gltf.h>

#include "model/mesh.h"
#include "offscreen/offscreen.h"

namespace packmerger {

inline constexpr double kMetresPerMm = 1e-3;

// glTF's axes: y up, z towards the viewer.
inline Vec3 gltf_axes(const Vec3& v) { return {v.x(), v.z(), -v.y()}; }

// With its one buffer, empty yet.
tinygltf::Model empty_gltf();

// Puts bytes into the buffer, at a multiple of four; the index of the view. stride_bytes 0: without
// gaps.
int add_view(tinygltf::Model& model, const void* data, std::size_t bytes, int target,
             std::size_t stride_bytes = 0);

int add_material(tinygltf::Model& model, const std::string& name, const Colour& colour);

// The bytes as GLB. Throws Error{kInternal} when tinygltf fails.
std::string glb_of(tinygltf::Model& model);

}  // namespace packmerger
