// What packmerger and packmerger-tetgen tell each other, as two small binary files in the machine's
// own byte order.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "base/files.h"
#include "base/geometry.h"

namespace packmerger {

// A piecewise linear complex: triangles with a marker each, and a point in each hole.
struct TetgenInput {
  std::string flags;
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> facets;
  std::vector<int> markers;
  std::vector<Vec3> holes;
};

struct TetgenOutput {
  std::vector<Vec3> points;
  std::vector<std::array<int, 4>> tetrahedra;
  std::vector<std::array<int, 3>> faces;  // those on facets
  std::vector<int> markers;               // of faces
};

void write_tetgen_input(const fs::path& path, const TetgenInput& input);
TetgenInput read_tetgen_input(const fs::path& path);
void write_tetgen_output(const fs::path& path, const TetgenOutput& output);
// Reading throws Error{kInternal} when the file is damaged; indices are within points afterwards.
TetgenOutput read_tetgen_output(const fs::path& path);

}  // namespace packmerger
