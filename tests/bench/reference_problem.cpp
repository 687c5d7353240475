#include "bench/reference_problem.h"

#include <memory>

#include "job/divide.h"
#include "job/pack_models.h"

namespace packmerger::bench {

PackProblem paper_problem(const Mesh& surface, Profile profile, double grid_mm, double step_deg) {
  profile.pack.objective = Objective::kPaper;
  profile.pack.grid_mm = grid_mm;
  profile.pack.rotation_step_deg = step_deg;
  Warnings warnings;
  const auto divided =
      std::make_shared<const Divided>(divide(surface, profile, true, 1, warnings, Progress()));
  return packing_problem({divided}, profile, 1, 0);
}

DrawnParts draw_items(const PackProblem& problem, ReferencePacker& packer) {
  DrawnParts drawn;
  for (int item = 0; item < static_cast<int>(problem.items.size()); ++item) {
    drawn.maps.push_back(packer.draw({item}));
    drawn.volumes_mm3.push_back(problem.items[static_cast<std::size_t>(item)].volume_mm3);
  }
  return drawn;
}

}  // namespace packmerger::bench
