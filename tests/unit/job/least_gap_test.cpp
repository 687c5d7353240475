// A job whose profile asks for no gap at all.
#include <algorithm>
#include <cstdint>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "base/files.h"
#include "fixtures/models.h"
#include "job/prepare.h"
#include "model/stl.h"
#include "pack/exact/exact_gap.h"
#include "shape/read/read_model.h"
#include "shape/read/soup.h"

namespace packmerger {
namespace {

TEST(LeastGap, PartsOfAJobWithoutAGapAreApartInTheFiles) {
  const TemporaryFolder folder;
  PlanOptions options;
  options.models = {folder.path() / "torus.stl"};
  const Mesh torus = closed_mesh(fixtures::torus(13, 6, 16, 8));
  write_file_whole(options.models[0], binary_stl({&torus}));
  Profile profile = read_profile("objet30");
  profile.pack.gap_mm = 0;
  profile.pack.rotation_step_deg = 90;
  profile.shape.segmentation = Segmentation::kPrinter;
  profile.shape.parts = 4;
  profile.shape.wall_mm = 2;
  options.hollow = false;
  const fs::path out = folder.path() / "out";
  const Job job = prepare(profile, options, Variant::kPacked, out, Progress());
  ASSERT_GE(job.parts.size(), 2u);
  std::vector<std::vector<Mesh>> trays;
  for (const JobPart& part : job.parts) {
    const fs::path path = out / fmt::format("parts/{:02}.stl", part.id);
    const ModelFile file = read_model(read_file(path, std::uint64_t{1} << 20), path, Progress());
    trays.resize(std::max(trays.size(), static_cast<std::size_t>(part.tray)));
    trays[static_cast<std::size_t>(part.tray - 1)].push_back(closed_mesh(welded(file.soup, 0)));
  }
  for (const std::vector<Mesh>& parts : trays) EXPECT_GE(least_gap_mm(parts), 1e-4);
}

}  // namespace
}  // namespace packmerger
