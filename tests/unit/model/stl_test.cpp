// STL after rounding to floats: still the same closed surface.
#include "model/stl.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <set>

#include "base/error.h"
#include "base/random.h"
#include "fixtures/models.h"
#include "unit/tray/read_back.h"

namespace packmerger {
namespace {

using fixtures::sphere;

TEST(Stl, HoldsTheSameSurface) {
  const Mesh mesh = closed_mesh(fixtures::nested_cubes(30, 20));
  const auto facets = read_back::stl_facets(binary_stl({&mesh}));
  EXPECT_EQ(facets.size(), mesh.n_triangles());
  EXPECT_TRUE(read_back::is_closed(facets));
  EXPECT_NEAR(read_back::volume(facets), 27000 - 8000, 1e-6);
}

// Readers tell a binary STL from text by its length, by its first word, or by a byte above 127
// early on.
TEST(Stl, LooksBinaryToEveryReader) {
  const Mesh mesh = closed_mesh(fixtures::cube(10));
  const std::string bytes = binary_stl({&mesh});
  EXPECT_FALSE(bytes.starts_with("solid"));
  const std::string head = bytes.substr(80, 128);
  EXPECT_TRUE(
      std::ranges::any_of(head, [](char c) { return static_cast<unsigned char>(c) > 127; }));
}

TEST(Stl, StaysClosedWhereFloatsWeldVertices) {
  // A fine sphere far from the origin: a float's step there is larger than most edges.
  TriangleSoup soup = sphere(1e-4, 4);
  for (Vec3& point : soup.points) point += Vec3(250, 180, 150);
  const Mesh mesh = closed_mesh(soup);
  std::set<std::array<float, 3>> welded;
  for (const Vec3& p : soup.points)
    welded.insert(
        {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())});
  ASSERT_LT(welded.size(), soup.points.size()) << "the test must force rounding to weld";

  const auto facets = read_back::stl_facets(binary_stl({&mesh}));
  EXPECT_EQ(facets.size(), mesh.n_triangles());
  EXPECT_TRUE(read_back::is_closed(facets));
  const auto points = float_points({&mesh}).front();
  for (std::size_t i = 0; i < points.size(); ++i)
    EXPECT_LT((points[i].cast<double>() - soup.points[i]).norm(), 2e-3);
}

TEST(Stl, PartsThatTouchDoNotWeld) {
  const Mesh left = closed_mesh(fixtures::cube(10));
  const Mesh right = closed_mesh(fixtures::box({10, 0, 0}, {20, 10, 10}));
  const auto facets = read_back::stl_facets(binary_stl({&left, &right}));
  EXPECT_TRUE(read_back::is_closed(facets));
  EXPECT_NEAR(read_back::volume(facets), 2000, 0.01);
}

TEST(Stl, NothingSinksBelowThePlate) {
  TriangleSoup soup = sphere(20, 3);
  double low = 0;
  for (const Vec3& point : soup.points) low = std::min(low, point.z());
  for (Vec3& point : soup.points) point += Vec3(20, 20, -low - 1e-13);
  const Mesh mesh = closed_mesh(soup);
  for (const auto& facet : read_back::stl_facets(binary_stl({&mesh})))
    for (const auto& corner : facet) EXPECT_GE(corner[2], 0);
}

TEST(Stl, TheSameMeshGivesTheSameBytes) {
  const Mesh mesh = closed_mesh(fixtures::blob(60, 4));
  EXPECT_EQ(binary_stl({&mesh}), binary_stl({&mesh}));
}

TEST(Stl, RandomPosesStayClosed) {
  Random random(3);
  const Mesh mesh = closed_mesh(fixtures::torus(20, 4, 60, 30));
  for (int round = 0; round < 20; ++round) {
    Pose pose = Pose::Identity();
    pose.linear() = Eigen::Quaterniond(random.unit() - 0.5, random.unit() - 0.5,
                                       random.unit() - 0.5, random.unit() - 0.5)
                        .normalized()
                        .toRotationMatrix();
    pose.translation() = Vec3(random.unit(), random.unit(), random.unit()) * 300;
    const Mesh placed = transformed(mesh, pose);
    const auto facets = read_back::stl_facets(binary_stl({&placed}));
    EXPECT_TRUE(read_back::is_closed(facets));
    EXPECT_NEAR(read_back::volume(facets), volume_mm3(mesh), 1e-3 * volume_mm3(mesh));
  }
}

TEST(Stl, RealModelsStayClosedInAnyPose) {
  PACKMERGER_TEST_MODEL(spot, "spot.obj");
  const Mesh mesh = closed_mesh(fixtures::scaled_to(spot, 138));
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::AngleAxisd(1, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  pose.translation() = Vec3(200, 300, 250);
  const Mesh placed = transformed(mesh, pose);
  EXPECT_TRUE(read_back::is_closed(read_back::stl_facets(binary_stl({&placed}))));
}

TEST(Stl, NumbersThatAreNoCoordinatesAreRefused) {
  for (const double bad :
       {std::numeric_limits<double>::infinity(), 1e300, std::numeric_limits<double>::quiet_NaN()}) {
    TriangleSoup soup = fixtures::cube(10);
    soup.points[3] = Vec3(bad, 0, 0);
    const Mesh mesh = closed_mesh(soup);
    EXPECT_THROW(binary_stl({&mesh}), Error);
  }
}

}  // namespace
}  // namespace packmerger
