// What the table packs, each made anew from its seed.
#pragma once

#include <cstdint>
#include <memory>

#include "job/divide.h"
#include "model/packing.h"

namespace packmerger::bench {

// Where the least height is sought: rotations of 90 degrees, cells of 1 mm.
PackProblem height_problem(std::vector<PackItem> items, const Vec3& build_mm, double gap_mm);

// 28 small parts (mixed_parts.h) on 100 x 100 mm, no gap.
PackProblem mixed_problem(std::uint64_t instance);

// 60 functional parts (functional_parts.h) on 150 x 110 mm, 1 mm apart.
PackProblem functional_problem(std::uint64_t instance);

// 60 mixed parts in powder, 165 x 165 x 300 mm: 1 mm apart and from every wall, so that the packer's
// volume is 2 mm smaller each way, and so is the density's.
PackProblem powder_problem(std::uint64_t instance);

// The six patches that the faces of a cube cut out of a shell, 50 mm in radius and 3 mm thick, on
// 72 x 72 mm, no gap. At best they lie in one another as bowls do, nested_height_mm() high.
PackProblem nested_problem();
double nested_height_mm();

// `count` boats (hull_part.h) for a volume of 165 x 165 x 320 mm, 1 mm apart.
PackProblem hull_problem(int count);

// The parts of the bunny, 100 mm long, as its job for objet30 has them where eight are
// asked for, on 110 x 110 mm, 1 mm apart. Throws what bunny_model() throws.
PackProblem bunny_parts_problem();

// The model divided for this printer by the planes that promise least support, or into the paper's
// clusters where no planes divide it: the same whoever packs it, because nobody packs on trial.
std::shared_ptr<const Divided> planned_division(const Mesh& model, const Profile& profile);

// `count` parts by the default settings of objet30: all different (the mixed parts at scales of
// their own), or copies of one bracket.
PackProblem growth_problem(int count, bool all_alike, std::uint64_t instance);

}  // namespace packmerger::bench
