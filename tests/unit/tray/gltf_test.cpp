// GLB scenes: valid by the Khronos validator, in metres, every part at its place.
#include "picture/gltf.h"

#include <gtest/gtest.h>

#include "picture/part_colour.h"
#include "unit/tray/glb_file.h"
#include "unit/tray/sample_job.h"

namespace packmerger {
namespace {

std::vector<GltfPart> parts_of(const Job& job) {
  std::vector<GltfPart> parts;
  for (const JobPart& part : job.parts)
    parts.push_back({"part " + std::to_string(part.id), &part.surface, part.pose,
                     part_colour(part.id - 1), Vec3(part.id == 4 ? 300 : 0, 0, 0)});
  return parts;
}

TEST(Gltf, KhronosValidatorFindsNoError) {
  const fs::path packages = node_packages();
  if (packages.empty()) GTEST_SKIP() << kNoValidator;
  const Job job = fixtures::sample_job();
  const TemporaryFolder folder;
  write_file_whole(folder.path() / "all.glb", glb_bytes(parts_of(job)));
  // a triangle without area, and a vertex whose faces cancel out
  TriangleSoup soup = fixtures::box({0, 0, 0}, {10, 10, 1e-9});
  soup.points[0] = soup.points[1];
  const Mesh flat = closed_mesh(soup);
  write_file_whole(folder.path() / "flat.glb",
                   glb_bytes({{"flat", &flat, Pose::Identity(), {}, {}}}));

  const Json reports = validated(packages, {folder.path() / "all.glb", folder.path() / "flat.glb"});
  ASSERT_EQ(reports.size(), 2U);
  for (const Json& report : reports) EXPECT_EQ(report["numErrors"], 0) << report.dump(1);
  EXPECT_EQ(reports[0]["numWarnings"], 0) << reports[0].dump(1);
}

TEST(Gltf, IsInMetresWithYUp) {
  const Job job = fixtures::sample_job();
  const Glb glb = read_glb(glb_bytes(parts_of(job)));
  ASSERT_EQ(glb.json["nodes"].size(), job.parts.size());
  for (std::size_t i = 0; i < job.parts.size(); ++i) {
    const Json& node = glb.json["nodes"][i];
    const Json& mesh = glb.json["meshes"][node["mesh"].get<std::size_t>()];
    const Json& primitive = mesh["primitives"][0];
    const Json& accessor =
        glb.json["accessors"][primitive["attributes"]["POSITION"].get<std::size_t>()];
    const Box3 box = bounding_box(transformed(job.parts[i].surface, job.parts[i].pose));
    const Vec3 low(box.min().x(), box.min().z(), -box.max().y());
    const Vec3 high(box.max().x(), box.max().z(), -box.min().y());
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(accessor["min"][axis].get<double>() * 1000, low[static_cast<int>(axis)], 1e-3);
      EXPECT_NEAR(accessor["max"][axis].get<double>() * 1000, high[static_cast<int>(axis)], 1e-3);
    }
    EXPECT_EQ(node.contains("translation"), i == 3);
  }
}

TEST(Gltf, SharpEdgesStaySharpAndBluntOnesSmooth) {
  const auto points_of = [](const TriangleSoup& soup) {
    const Mesh mesh = closed_mesh(soup);
    const Glb glb = read_glb(glb_bytes({{"one", &mesh, Pose::Identity(), {}, {}}}));
    return glb.json["accessors"][0]["count"].get<int>();
  };
  EXPECT_EQ(points_of(fixtures::cube(10)), 24);  // three normals at each of eight corners
  const TriangleSoup ball = fixtures::sphere(10, 4);
  EXPECT_EQ(points_of(ball), static_cast<int>(ball.points.size()));
}

TEST(Gltf, ColoursAreThoseOfThePicturesInLinearLight) {
  const Job job = fixtures::sample_job();
  const Glb glb = read_glb(glb_bytes(parts_of(job)));
  const Json& factor = glb.json["materials"][1]["pbrMetallicRoughness"]["baseColorFactor"];
  const double shown = part_colour(1).red;
  EXPECT_NEAR(factor[0].get<double>(), std::pow((shown + 0.055) / 1.055, 2.4), 1e-6);
}

TEST(PartColour, NeighboursAreFarApartAndNeverGrey) {
  for (int i = 0; i < 100; ++i) {
    const Colour a = part_colour(i);
    const float high = std::max({a.red, a.green, a.blue});
    const float low = std::min({a.red, a.green, a.blue});
    EXPECT_GT(high - low, 0.2F);
    for (int j = i + 1; j < i + 8; ++j) {
      const Colour b = part_colour(j);
      EXPECT_GT(std::hypot(a.red - b.red, a.green - b.green, a.blue - b.blue), 0.1F)
          << i << " " << j;
    }
  }
}

}  // namespace
}  // namespace packmerger
