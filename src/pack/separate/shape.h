// A part as the separation sees it: distances round it, samples of its surface, and the mesh.
#pragma once

#include <vector>

#include "model/mesh.h"
#include "pack/exact/exact_gap.h"
#include "pack/separate/distance_grid.h"

namespace packmerger {

// Samples that lie close together.
struct SampleBall {
  Vec3f centre = Vec3f::Zero();
  float radius = 0;
  std::vector<Vec3f> samples;
};

// In a frame of its own, whose origin is the centre of the surface's box.
struct Shape {
  // mesh: closed, normals outward, model coordinates, mm. The distances reach reach_mm.
  Shape(const Mesh& mesh, double reach_mm);

  Vec3 centre;  // model coordinates
  Mesh mesh;
  double volume_mm3;
  double radius_mm;  // of a ball about the origin that holds the shape
  Vec3 half_mm;      // of the surface's box
  MovableSurface surface;
  Mesh outside;  // of the mesh: without the walls of closed chambers, which nothing gets into
  DistanceGrid distances;
  std::vector<SampleBall> balls;
  // Points that stand out: the whole shape lies within their convex hull, or for a mesh of very
  // many points, to within some hundredths of a millimetre.
  std::vector<Vec3> outermost;
};

}  // namespace packmerger
