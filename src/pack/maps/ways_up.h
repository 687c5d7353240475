// Which ways up a part can stand, and turned how.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "model/packing.h"
#include "pack/maps/rotations.h"

namespace packmerger {

// The rotation is turn_about_z(turn) * base.
struct WayUp {
  Mat3 base = Mat3::Identity();
  double turn = 0;                // the cheapest one, radians
  double cost = 0;                // Cost::evaluate of the part alone on the plate
  double support_mm3 = 0;         // V_s of the part alone
  double inside_support_mm3 = 0;  // V_s between the part's own surfaces
  Vec3 size_mm = Vec3::Zero();    // of the part standing so
};

struct Turn {
  double turn = 0;  // radians
  Vec3 size_mm = Vec3::Zero();
};

// The box of a surface that stands as it is given, in each of some turns about the vertical.
std::vector<Box3> turned_boxes(const Mesh& standing, const std::vector<double>& turns);

// The turn in which what stands fits the build volume and the plate at the least cost of its box;
// of equal ones the first. Empty where none fits. boxes: of each turn; standing: tells the
// surfaces, not turned, where a plate asks for more than boxes.
std::optional<Turn> best_turn(const std::vector<Box3>& boxes, const std::vector<double>& turns,
                              const std::function<std::vector<Mesh>()>& standing,
                              const PackProblem& problem);

struct FittingWay {
  Mat3 rotation = Mat3::Identity();
  Vec3 size_mm = Vec3::Zero();
};

// A rotation found by sampling and refining in which the surfaces fit the build volume although no
// rotation of the set did; empty where none was found.
std::optional<FittingWay> way_up_that_fits(const std::vector<Mesh>& surfaces,
                                           const PackProblem& problem);

// Large flat facets, as cuts by a plane leave them: normals as long as their area, mm², the largest
// first.
std::vector<Vec3> flat_facets(const std::vector<Mesh>& surfaces);

// Ways up in which the surfaces stand on a large flat facet of theirs; the largest first, at most
// `most`.
std::vector<Mat3> ways_on_flat_facets(const std::vector<Mesh>& surfaces, std::size_t most);

// Where a surface stands clear of the plate's walls, as a shift in x and y; empty where it does
// nowhere.
std::optional<Vec2> spot_on(const PackProblem& problem, const Mesh& standing);

// Whether a box fits the build volume, to within rounding.
bool fits(const Vec3& size_mm, const Vec3& build_mm);

}  // namespace packmerger
