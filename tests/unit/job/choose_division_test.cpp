#include "job/choose_division.h"

#include <gtest/gtest.h>

#include <memory>

#include "base/parallel.h"
#include "fixtures/models.h"
#include "job/pack_models.h"
#include "model/printer.h"
#include "pack/pack.h"
#include "shape/divide/adjacency.h"

namespace packmerger {
namespace {

Profile small_printer(Segmentation segmentation) {
  Profile profile = read_profile("objet30");
  profile.shape.segmentation = segmentation;
  profile.shape.parts = 4;
  profile.shape.wall_mm = 2;
  profile.pack.rotation_step_deg = 90;
  return profile;
}

Divided chosen(const Mesh& surface, const Profile& profile, std::uint64_t seed) {
  Warnings warnings;
  return choose_division(surface, profile, true, seed, warnings, {});
}

double packed(const Divided& divided, const Profile& profile, std::uint64_t seed) {
  PackProblem problem =
      packing_problem({std::make_shared<const Divided>(divided)}, profile, seed, 0);
  problem.edges.clear();
  return TrialPacking(problem, {}).searched_cost();
}

TEST(ChooseDivision, IsNoDearerThanTheClustersByMoreThanItMayGiveForFewerParts) {
  const Mesh surface = closed_mesh(fixtures::torus(13, 6, 16, 8));
  const Profile profile = small_printer(Segmentation::kPrinter);
  Warnings warnings;
  const Divided clusters = divide(surface, profile, true, 3, warnings, {});
  const Divided best = chosen(surface, profile, 3);
  EXPECT_LE(packed(best, profile, 3), 1.02 * packed(clusters, profile, 3));
  EXPECT_GE(best.segments.count, 2);
}

TEST(ChooseDivision, KeepsAllMatter) {
  const Mesh surface = closed_mesh(fixtures::blob(36, 2));
  const Divided best = chosen(surface, small_printer(Segmentation::kPrinter), 1);
  double sum = 0;
  for (const double volume : segment_volumes(best.tets, best.segments)) {
    EXPECT_GT(volume, 0);
    sum += volume;
  }
  // Points up to 0.02 mm beside a cut are moved onto it, those of the surface, too.
  EXPECT_NEAR(sum, best.shell.volume_mm3, 5e-5 * sum);
}

TEST(ChooseDivision, IsTheSameOnOneThreadAndOnTwo) {
  const Mesh surface = closed_mesh(fixtures::torus(13, 6, 16, 8));
  const Profile profile = small_printer(Segmentation::kPrinter);
  const Divided on_two = chosen(surface, profile, 5);
  const ThreadLimit one(1);
  const Divided on_one = chosen(surface, profile, 5);
  EXPECT_EQ(on_one.segments.of_tetrahedron, on_two.segments.of_tetrahedron);
}

TEST(ChooseDivision, ThePaperHasNoChoice) {
  const Mesh surface = closed_mesh(fixtures::torus(13, 6, 16, 8));
  const Profile profile = small_printer(Segmentation::kPaper);
  Warnings warnings;
  const Divided clusters = divide(surface, profile, true, 2, warnings, {});
  EXPECT_EQ(chosen(surface, profile, 2).segments.of_tetrahedron, clusters.segments.of_tetrahedron);
}

}  // namespace
}  // namespace packmerger
