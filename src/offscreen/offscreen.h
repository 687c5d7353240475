// Lit colour images without a display or a graphics card (OSMesa). Nothing else in the project
// knows OpenGL.
//
// Same input, same pixels, on any number of threads. Throws Error{kInternal} when the library
// cannot give a drawing surface.
#pragma once

#include <cstdint>
#include <vector>

#include "model/mesh.h"

namespace packmerger {

struct Colour {
  float red = 0.8F;  // 0..1, as they appear on screen (sRGB)
  float green = 0.8F;
  float blue = 0.8F;
};

struct SceneMesh {
  Mesh mesh;
  Colour colour;
  Pose pose = Pose::Identity();  // mesh → scene
};

struct SceneLine {
  Vec3 a = Vec3::Zero();
  Vec3 b = Vec3::Zero();
  Colour colour;
};

// Lengths in mm; z points up.
struct Scene {
  std::vector<SceneMesh> meshes;
  std::vector<SceneLine> lines;
  Colour background{1, 1, 1};
  double line_width_px = 1.5;  // in pixels of the finished image
};

// A perspective camera.
struct Camera {
  Vec3 eye{0, -1, 1};
  Vec3 target = Vec3::Zero();
  Vec3 up = Vec3::UnitZ();
  double field_of_view = radians(30);  // vertical, radians
};

// A camera that looks along `direction` at the whole of `box` in an image of the given aspect
// (width over height), with a small margin around it.
Camera camera_looking_at(const Box3& box, const Vec3& direction, double aspect);

// Rows from top to bottom, RGBA, alpha 255.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;
};

// Draws the scene lit from the camera's upper left and the sky, smooth across edges that turn less
// than 40° and sharp at others, both sides of every facet, hidden parts removed, antialiased by
// supersampling × supersampling samples a pixel. width, height: 1..4096; supersampling: 1..4.
Image draw(const Scene& scene, const Camera& camera, int width, int height, int supersampling = 3);

}  // namespace packmerger
