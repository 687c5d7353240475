// Writing 3MF: the core specification 1.x and nothing beyond it.
#pragma once

#include <string>
#include <vector>

#include "model/mesh.h"
#include "picture/part_colour.h"

namespace packmerger {

struct ThreeMfPart {
  std::string name;               // letters, digits and spaces
  const Mesh* surface = nullptr;  // model coordinates, mm
  Pose pose = Pose::Identity();   // model → tray
  Colour colour;
};

// One object per part, in its own coordinates, placed by one build item each; unit millimetre; a
// colour per part as a base material. Vertices are 32-bit floats, no two of a part equal, as in
// model/stl.h. The same parts give the same bytes. Throws Error{kBadInput} where float_points()
// does, Error{kInternal} when the archive cannot be made.
std::string three_mf_bytes(const std::vector<ThreeMfPart>& parts);

}  // namespace packmerger
