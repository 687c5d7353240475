// Pictures of a job (preview.png) and of cuts, drawn off screen.
#pragma once

#include <string>
#include <vector>

#include "model/job.h"
#include "model/mesh.h"
#include "offscreen/offscreen.h"

namespace packmerger {

// The packed tray beside the model as it was, at one scale, lit and shaded, both standing on a
// plate of this printer with its build volume drawn as a box; a part has its part_colour(). Where
// there are several trays, they stand one after the other.
Image preview_picture(const Job& job);

// A surface with a segment number for each of its faces.
struct ColouredMesh {
  Mesh surface;
  std::vector<int> segment_of_face;  // one for each face
};

// Two states of the same model side by side at one scale, each segment in its part_colour() and
// the curves between segments drawn dark: how smoothing changes the cuts.
Image cut_picture(const ColouredMesh& before, const ColouredMesh& after);

// PNG, 8 bits a channel, RGB. Throws Error{kInternal} when libpng fails.
std::string png_bytes(const Image& image);

}  // namespace packmerger
