// packmerger-tetgen INPUT OUTPUT: runs TetGen in a process of its own, since TetGen may end in a
// segmentation fault. The only file that includes tetgen.h. Exit codes: 0 done, 1 TetGen refused,
// 2 wrong usage, otherwise those of Error.
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <vector>

#include <tetgen.h>

#include "base/error.h"
#include "shape/solid/tetgen_files.h"

namespace packmerger {
namespace {

// tetgenio frees what it is given with delete[].
REAL* new_numbers(const std::vector<Vec3>& points) {
  REAL* numbers = new REAL[3 * points.size()];
  for (std::size_t i = 0; i < points.size(); ++i)
    for (int axis = 0; axis < 3; ++axis)
      numbers[3 * i + static_cast<std::size_t>(axis)] = points[i][axis];
  return numbers;
}

void fill(tetgenio& io, const TetgenInput& input) {
  io.numberofpoints = static_cast<int>(input.points.size());
  io.pointlist = new_numbers(input.points);
  io.numberoffacets = static_cast<int>(input.facets.size());
  io.facetlist = new tetgenio::facet[input.facets.size()];
  io.facetmarkerlist = new int[input.facets.size()];
  for (std::size_t i = 0; i < input.facets.size(); ++i) {
    tetgenio::facet& facet = io.facetlist[i];
    tetgenio::init(&facet);
    facet.numberofpolygons = 1;
    facet.polygonlist = new tetgenio::polygon[1];
    facet.polygonlist[0].numberofvertices = 3;
    facet.polygonlist[0].vertexlist = new int[3];
    for (int k = 0; k < 3; ++k) facet.polygonlist[0].vertexlist[k] = input.facets[i][k];
    io.facetmarkerlist[i] = input.markers[i];
  }
  if (input.holes.empty()) return;
  io.numberofholes = static_cast<int>(input.holes.size());
  io.holelist = new_numbers(input.holes);
}

TetgenOutput taken(const tetgenio& io) {
  TetgenOutput output;
  for (int i = 0; i < io.numberofpoints; ++i)
    output.points.emplace_back(io.pointlist[3 * i], io.pointlist[3 * i + 1],
                               io.pointlist[3 * i + 2]);
  for (int i = 0; i < io.numberoftetrahedra; ++i) {
    const int* corner = io.tetrahedronlist + static_cast<std::ptrdiff_t>(i) * io.numberofcorners;
    output.tetrahedra.push_back({corner[0], corner[1], corner[2], corner[3]});
  }
  for (int i = 0; i < io.numberoftrifaces; ++i) {
    const int* corner = io.trifacelist + static_cast<std::ptrdiff_t>(3) * i;
    output.faces.push_back({corner[0], corner[1], corner[2]});
    output.markers.push_back(io.trifacemarkerlist != nullptr ? io.trifacemarkerlist[i] : 0);
  }
  return output;
}

int run(const char* input_path, const char* output_path) {
  TetgenInput input = read_tetgen_input(input_path);
  tetgenio in;
  tetgenio out;
  fill(in, input);
  try {
    tetrahedralize(input.flags.data(), &in, &out);
  } catch (int code) {
    std::fprintf(stderr, "TetGen refused the surface (%d)\n", code);
    return 1;
  }
  write_tetgen_output(output_path, taken(out));
  return 0;
}

}  // namespace
}  // namespace packmerger

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs("usage: packmerger-tetgen INPUT OUTPUT\n", stderr);
    return 2;
  }
  try {
    return packmerger::run(argv[1], argv[2]);
  } catch (const packmerger::Error& error) {
    std::fprintf(stderr, "%s\n%s\n", error.what(), error.hint().c_str());
    return error.exit_code();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return static_cast<int>(packmerger::Fault::kInternal);
  }
}
