#include "job/load_models.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/files.h"
#include "fixtures/models.h"
#include "model/stl.h"

namespace packmerger {
namespace {

TEST(LoadModels, OverlappingBodiesOfAFileAreCountedOnce) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "two cubes.stl";
  const Mesh first = closed_mesh(fixtures::cube(40));
  const Mesh second = closed_mesh(fixtures::box(Vec3::Constant(20), Vec3::Constant(60)));
  write_file_whole(path, binary_stl({&first, &second}));
  Warnings warnings;
  const auto models = load_models({path, path}, {}, warnings, Progress());
  ASSERT_EQ(models.size(), 2u);
  EXPECT_EQ(models[0].surface, models[1].surface) << "copies share one surface";
  EXPECT_NEAR(volume_mm3(*models[0].surface), 120000, 1);
  EXPECT_EQ(models[0].input.sha256, sha256_hex_of_file(path));
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0].code, "shape_changed");
}

TEST(LoadModels, ASizeIsThatOfWhatIsPrinted) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "stray.obj";
  std::string text = "v 500 0 0\n";  // no face needs it
  const TriangleSoup cube = fixtures::cube(10);
  for (const Vec3& point : cube.points)
    text += fmt::format("v {} {} {}\n", point.x(), point.y(), point.z());
  for (const auto& [a, b, c] : cube.triangles)
    text += fmt::format("f {} {} {}\n", a + 2, b + 2, c + 2);
  write_file_whole(path, text);
  Sizing sizing;
  sizing.size_mm = 20;
  Warnings warnings;
  const auto models = load_models({path}, sizing, warnings, Progress());
  EXPECT_NEAR(bounding_box(*models[0].surface).sizes().maxCoeff(), 20, 1e-9);
}

}  // namespace
}  // namespace packmerger
