// A comparison is known only where nothing that it depends on is another.
#include "job/comparison_key.h"

#include <gtest/gtest.h>

#include <functional>
#include <set>

namespace packmerger {
namespace {

TEST(ComparisonKey, ChangesWithWhateverTheFiguresDependOn) {
  const std::vector<JobInput> models(2, {"cube.stl", std::string(64, 'a')});
  const std::vector<std::function<void(Profile&, PlanOptions&, std::vector<JobInput>&)>> changes = {
      [](auto&, auto&, auto&) {},
      [](auto& profile, auto&, auto&) { profile.fdm.start_s += 1; },
      [](auto& profile, auto&, auto&) { profile.cost.currency = "CHF"; },
      [](auto& profile, auto&, auto&) { profile.dialect = Dialect::kGcode; },
      [](auto&, auto& options, auto&) { options.sizing.scale = 2; },
      [](auto&, auto& options, auto&) { options.sizing.unit_mm = 25.4; },
      [](auto&, auto& options, auto&) { options.sizing.size_mm = 40; },
      [](auto&, auto& options, auto&) { options.split = false; },
      [](auto&, auto& options, auto&) { options.hollow = false; },
      [](auto&, auto& options, auto&) { options.seed = 2; },
      [](auto&, auto& options, auto&) { options.budget_s = 3; },
      [](auto&, auto&, auto& inputs) { inputs[0].sha256[0] = 'b'; },
      [](auto&, auto&, auto& inputs) { inputs[0].file = "cube.obj"; },
      [](auto&, auto&, auto& inputs) { inputs.pop_back(); }};
  std::set<std::string> keys;
  for (const auto& change : changes) {
    Profile profile;
    PlanOptions options;
    std::vector<JobInput> inputs = models;
    change(profile, options, inputs);
    keys.insert(comparison_sha256(profile, options, inputs));
  }
  EXPECT_EQ(keys.size(), changes.size());
  EXPECT_TRUE(keys.contains(comparison_sha256(Profile{}, PlanOptions{}, models)));
}

}  // namespace
}  // namespace packmerger
