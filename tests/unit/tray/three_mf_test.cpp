// tray.3mf read back with libzip and pugixml.
#include "tray/three_mf.h"

#include <gtest/gtest.h>

#include <set>

#include "unit/tray/read_back.h"
#include "unit/tray/sample_job.h"

namespace packmerger {
namespace {

std::vector<ThreeMfPart> parts_of(const Job& job) {
  std::vector<ThreeMfPart> parts;
  for (const JobPart& part : job.parts)
    parts.push_back({"part " + std::to_string(part.id), &part.surface, part.pose, {1, 0.5F, 0}});
  return parts;
}

TEST(ThreeMf, IsAPackageOfTheCoreSpecification) {
  const Job job = fixtures::sample_job();
  const auto entries = read_back::zip_entries(three_mf_bytes(parts_of(job)));
  ASSERT_EQ(entries.size(), 3U);
  pugi::xml_document types;
  ASSERT_TRUE(types.load_string(entries.at("[Content_Types].xml").c_str()));
  std::set<std::string> extensions;
  for (const auto& node : types.child("Types").children("Default"))
    extensions.insert(node.attribute("Extension").value());
  EXPECT_EQ(extensions, (std::set<std::string>{"rels", "model"}));
  pugi::xml_document relationships;
  ASSERT_TRUE(relationships.load_string(entries.at("_rels/.rels").c_str()));
  EXPECT_STREQ(
      relationships.child("Relationships").child("Relationship").attribute("Target").value(),
      "/3D/3dmodel.model");
  pugi::xml_document model;
  ASSERT_TRUE(model.load_string(entries.at("3D/3dmodel.model").c_str()));
  EXPECT_STREQ(model.child("model").attribute("xmlns").value(),
               "http://schemas.microsoft.com/3dmanufacturing/core/2015/02");
}

TEST(ThreeMf, PutsEveryPartWhereItStands) {
  const Job job = fixtures::sample_job();
  const auto objects = read_back::objects_3mf(three_mf_bytes(parts_of(job)));
  ASSERT_EQ(objects.size(), job.parts.size());
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const Mesh& surface = job.parts[i].surface;
    ASSERT_EQ(objects[i].points.size(), surface.n_points());
    EXPECT_EQ(objects[i].triangles, surface.triangles());
    for (std::size_t k = 0; k < surface.n_points(); ++k)
      EXPECT_LT(
          (objects[i].pose * objects[i].points[k] - job.parts[i].pose * surface.points()[k]).norm(),
          1e-4);
  }
}

TEST(ThreeMf, MeetsTheSpecificationsRulesForMeshes) {
  const Job job = fixtures::sample_job();
  for (const auto& object : read_back::objects_3mf(three_mf_bytes(parts_of(job)))) {
    std::set<std::array<double, 3>> places;
    for (const Vec3& p : object.points) {
      places.insert({p.x(), p.y(), p.z()});
      EXPECT_GE((object.pose * p).minCoeff(), -1e-4);  // all in the positive octant
    }
    EXPECT_EQ(places.size(), object.points.size());
    for (const auto& [a, b, c] : object.triangles) {
      EXPECT_TRUE(a != b && b != c && c != a);
      for (const int corner : {a, b, c})
        EXPECT_TRUE(corner >= 0 && corner < static_cast<int>(object.points.size()));
    }
    EXPECT_NEAR(object.pose.linear().determinant(), 1, 1e-9);
  }
}

TEST(ThreeMf, TheSamePartsGiveTheSameBytes) {
  const Job job = fixtures::sample_job();
  EXPECT_EQ(three_mf_bytes(parts_of(job)), three_mf_bytes(parts_of(job)));
}

}  // namespace
}  // namespace packmerger
