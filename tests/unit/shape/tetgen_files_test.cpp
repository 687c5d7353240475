#include "shape/solid/tetgen_files.h"

#include <gtest/gtest.h>

#include "base/error.h"

namespace packmerger {
namespace {

TEST(TetgenFiles, ComeBackAsWritten) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "file";
  const TetgenInput input{"pQ", {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}, {{0, 1, 2}}, {2}, {}};
  write_tetgen_input(path, input);
  const TetgenInput found = read_tetgen_input(path);
  EXPECT_EQ(found.flags, input.flags);
  EXPECT_EQ(found.points, input.points);
  EXPECT_EQ(found.facets, input.facets);
  EXPECT_EQ(found.markers, input.markers);
  EXPECT_TRUE(found.holes.empty());
}

TEST(TetgenFiles, EveryTruncationIsRefused) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "file";
  TetgenOutput output;
  output.points.assign(4, Vec3::Zero());
  output.tetrahedra = {{0, 1, 2, 3}};
  output.faces = {{0, 1, 2}};
  output.markers = {1};
  write_tetgen_output(path, output);
  const std::string whole = read_file(path, 1 << 20);
  EXPECT_EQ(read_tetgen_output(path).tetrahedra, output.tetrahedra);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    write_file_whole(path, whole.substr(0, size));
    EXPECT_THROW(read_tetgen_output(path), Error) << size;
  }
  output.tetrahedra[0][2] = 4;
  write_tetgen_output(path, output);
  EXPECT_THROW(read_tetgen_output(path), Error);
}

}  // namespace
}  // namespace packmerger
