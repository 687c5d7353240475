// The page's small scene: valid, every part at both its places, and small.
#include "picture/page_scene.h"

#include "picture/part_colour.h"
#include "unit/tray/glb_file.h"
#include "unit/tray/sample_job.h"

namespace packmerger {
namespace {

std::vector<PagePart> parts_of(const Job& job) {
  std::vector<PagePart> parts;
  for (const JobPart& part : job.parts)
    parts.push_back({part.id, &part.surface, part.pose, Vec3(part.id == 4 ? 300 : 0, 0, 0),
                     Vec3(0, 0, 0), part_colour(part.id - 1)});
  return parts;
}

// A node's points in the scene, in metres.
std::vector<Vec3> points_of(const Glb& glb, const Json& node) {
  const Json& attributes =
      glb.json["meshes"][node["mesh"].get<std::size_t>()]["primitives"][0]["attributes"];
  const Json& accessor = glb.json["accessors"][attributes["POSITION"].get<std::size_t>()];
  const Json& view = glb.json["bufferViews"][accessor["bufferView"].get<std::size_t>()];
  const auto read = [&](const char* key, double otherwise) {
    const std::vector<double> all = node.value(key, std::vector<double>(4, otherwise));
    return Vec3(all[0], all[1], all[2]);
  };
  const std::vector<double> turn = node.value("rotation", std::vector<double>{0, 0, 0, 1});
  const Eigen::Quaterniond rotation(turn[3], turn[0], turn[1], turn[2]);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < accessor["count"].get<std::size_t>(); ++i) {
    std::uint16_t steps[3];
    std::memcpy(steps, glb.binary.data() + view.value("byteOffset", 0U) + 8 * i, sizeof steps);
    const Vec3 whole(steps[0], steps[1], steps[2]);
    points.push_back(rotation * whole.cwiseProduct(read("scale", 1)) + read("translation", 0));
  }
  return points;
}

// The box of a surface where the scene shows it, in metres with y up.
Box3 shown_box(const Mesh& surface, const Pose& pose, const Vec3& aside_mm) {
  Box3 box;
  for (const Vec3& at : surface.points()) {
    const Vec3 point = pose * at + aside_mm;
    box.extend(Vec3(point.x(), point.z(), -point.y()) / 1000);
  }
  return box;
}

TEST(PageScene, EveryPartIsAtBothItsPlaces) {
  const Job job = fixtures::sample_job();
  const std::vector<PagePart> parts = parts_of(job);
  const Glb glb = read_glb(page_glb(parts));
  ASSERT_EQ(glb.json["scenes"].size(), 2u);
  ASSERT_EQ(glb.json["meshes"].size(), parts.size()) << "both scenes show the same meshes";
  for (std::size_t scene = 0; scene < 2; ++scene) {
    const Json& nodes = glb.json["scenes"][scene]["nodes"];
    ASSERT_EQ(nodes.size(), parts.size());
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const Json& node = glb.json["nodes"][nodes[i].get<std::size_t>()];
      EXPECT_EQ(node["extras"]["part"], parts[i].id);
      const Box3 expected =
          scene == 0 ? shown_box(*parts[i].surface, parts[i].on_tray, parts[i].aside_on_tray_mm)
                     : shown_box(*parts[i].surface, Pose::Identity(), parts[i].aside_in_model_mm);
      Box3 box;
      for (const Vec3& point : points_of(glb, node)) box.extend(point);
      const double near = 1e-4 * expected.sizes().maxCoeff();
      EXPECT_LT((box.min() - expected.min()).cwiseAbs().maxCoeff(), near);
      EXPECT_LT((box.max() - expected.max()).cwiseAbs().maxCoeff(), near);
    }
  }
}

TEST(PageScene, IsSmallHoweverFineTheModelIs) {
  const Mesh ball = closed_mesh(fixtures::sphere(50, 7));
  ASSERT_GT(ball.n_triangles(), 100000u);
  const std::string bytes = page_glb({{1, &ball, Pose::Identity(), {}, {}, part_colour(0)}});
  EXPECT_LT(bytes.size(), 700000u);
  const Glb glb = read_glb(bytes);
  for (const Vec3& point : points_of(glb, glb.json["nodes"][0]))
    EXPECT_NEAR(point.norm(), 0.05, 0.0003);
}

TEST(PageScene, KhronosValidatorFindsNoError) {
  const fs::path packages = node_packages();
  if (packages.empty()) GTEST_SKIP() << kNoValidator;
  const Job job = fixtures::sample_job();
  const TemporaryFolder folder;
  write_file_whole(folder.path() / "page.glb", page_glb(parts_of(job)));
  const Json reports = validated(packages, {folder.path() / "page.glb"});
  EXPECT_EQ(reports[0]["numErrors"], 0) << reports[0].dump(1);
  EXPECT_EQ(reports[0]["numWarnings"], 0) << reports[0].dump(1);
}

}  // namespace
}  // namespace packmerger
