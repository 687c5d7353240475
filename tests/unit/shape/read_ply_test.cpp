// PLY files as they are met: strips, quads, lists of other names and types, scans.
#include <cstdint>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fixtures/fault_of.h"
#include "shape/read/read_model.h"
#include "shape/read/soup.h"
#include "unit/shape/written.h"

namespace packmerger {
namespace {

using testing::HasSubstr;

TriangleSoup read(const std::string& bytes) {
  return read_model_bytes(bytes, "ply", Progress()).soup;
}

std::string refusal(const std::string& bytes) {
  return fixtures::refusal_of([&] { read(bytes); });
}

const std::string kPoints = "property float x\nproperty float y\nproperty float z\n";

// The corner (0,0,0), (1,0,0), (0,1,0), (0,0,1), whose volume is a sixth; rest: the header's and
// the body's other elements.
std::string tetrahedron(const std::string& elements, const std::string& body) {
  return "ply\nformat ascii 1.0\nelement vertex 4\n" + kPoints + elements +
         "end_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n" + body;
}

void expect_tetrahedron(const TriangleSoup& soup) {
  EXPECT_EQ(soup.triangles.size(), 4u);
  EXPECT_EQ(count_open_edges(soup), 0);
  EXPECT_NEAR(signed_volume_mm3(soup), 1.0 / 6, 1e-9);
}

TEST(ReadPly, StripsTurnEveryOtherTriangle) {
  const std::string list = "element tristrips 1\nproperty list int int vertex_indices\n";
  for (const char* strips : {"6 0 2 1 3 0 2\n", "13 0 2 1 3 -1 3 0 1 -1 0 3 2 -1\n",
                             "18 -1 0 2 1 3 -1 3 0 -1 1 -1 3 0 1 -1 0 3 2\n",  // and some too short
                             "9 0 2 1 3 0 0 0 3 2\n"}) {  // joined by repeated corners
    SCOPED_TRACE(strips);
    expect_tetrahedron(read(tetrahedron(list, strips)));
  }
  expect_tetrahedron(
      read(tetrahedron("element tristrips 2\nproperty float quality\n"
                       "property list uchar uint vertex_index\n",
                       "0.5 4 0 2 1 3\n0.5 8 4294967295 3 0 1 4294967295 0 3 2\n")));
  EXPECT_THAT(refusal(tetrahedron(list, "3 0 1 4\n")), HasSubstr("names point 4 of 4"));
  EXPECT_THAT(refusal(tetrahedron(list, "3 0 1 -2\n")), HasSubstr("names point -2 of 4"));
  EXPECT_THAT(refusal(tetrahedron(list, "5 0 1 2\n")), HasSubstr("ends too early"));
}

TEST(ReadPly, BinaryStripsOfEitherByteOrder) {
  for (const bool big : {false, true}) {
    SCOPED_TRACE(big);
    std::string bytes = std::string("ply\nformat binary_") + (big ? "big" : "little") +
                        "_endian 1.0\nelement vertex 4\n" + kPoints +
                        "element tristrips 1\nproperty list int int vertex_indices\nend_header\n";
    for (const float number : {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1})
      written::put(bytes, number, big);
    for (const std::int32_t number : {10, 0, 2, 1, 3, 0, -1, 0, 3, 2, -1})
      written::put(bytes, number, big);
    expect_tetrahedron(read(bytes));
    EXPECT_THAT(refusal(bytes.substr(0, bytes.size() - 1)), HasSubstr("ends too early"));
  }
}

TEST(ReadPly, FacesOfAnyNumberOfCornersBesideOtherProperties) {
  expect_tetrahedron(read(tetrahedron(
      "element face 4\nproperty uchar red\nproperty list uchar short vertex_index\n"
      "property list uchar float texcoord\nproperty int group\n"
      "element edge 1\nproperty int vertex1\nproperty int vertex2\n",
      "255 3 0 2 1 6 0 0 0 1 1 1 7\n255 3 0 1 3 0 7\n255 3 1 2 3 0 7\n255 3 0 3 2 0 7\n0 1\n")));
  const TriangleSoup quads =
      read("ply\nformat ascii 1.0\nelement vertex 8\n" + kPoints +
           "property list uchar int neighbours\nelement face 6\nproperty list uint8 uint16 "
           "vertex_indices\n"
           "end_header\n0 0 0 1 5\n1 0 0 0\n1 1 0 0\n0 1 0 0\n0 0 1 0\n1 0 1 0\n1 1 1 0\n0 1 1 0\n"
           "4 0 3 2 1\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n");
  EXPECT_EQ(quads.triangles.size(), 12u);
  EXPECT_EQ(count_open_edges(quads), 0);
  EXPECT_NEAR(signed_volume_mm3(quads), 1, 1e-9);
}

TEST(ReadPly, NamesWhatIsNoSurface) {
  EXPECT_THAT(refusal(tetrahedron("", "")), HasSubstr("holds points, but no triangles"));
  EXPECT_THAT(refusal(tetrahedron("element range_grid 4\nproperty list uchar int vertex_indices\n",
                                  "1 0\n0\n1 1\n1 2\n")),
              HasSubstr("a scan's range grid"));
  EXPECT_THAT(
      refusal(tetrahedron("element face 1\nproperty list uchar int corners\n", "3 0 1 2\n")),
      HasSubstr("vertex_indices"));
  EXPECT_THAT(refusal(tetrahedron("element face 1\nproperty int vertex_indices\n", "3\n")),
              HasSubstr("vertex_indices"));
  EXPECT_THAT(refusal("ply\nformat ascii 1.0\nelement vertex 1\nproperty float u\n"
                      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0\n"
                      "3 0 0 0\n"),
              HasSubstr("no x, y and z"));
}

}  // namespace
}  // namespace packmerger
