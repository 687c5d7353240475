// The models of the paper's figures and of its Table 1, generated. The paper gives no sizes: those
// of the sphere, the bunny and the molecule follow from Table 1's solid rows and the estimators
// (docs/ESTIMATES.md), those of the others are such that the row can be told about.
//
// Every model is closed, 2-manifold and does not cross itself; z points up, the lowest point is at
// z = 0, as the paper printed the solid ones. Lengths in mm. Same bytes on every run.
#pragma once

#include <vector>

#include "model/mesh.h"

namespace packmerger::bench {

// Figure 10. Sphere, 20,480 triangles.
inline constexpr double kSphereDiameter_mm = 80;
Mesh sphere_model();

// Figure 9. An arch of rectangular section: half a ring, width across and inner radius below, on
// two straight legs; it stands on its feet and is larger than a tray of 203×203×152 mm whichever
// way it lies. Hollowed to a wall of 3 mm it holds about the 167 cm³ that the paper printed.
inline constexpr double kArchWidth_mm = 240;
inline constexpr double kArchHeight_mm = 185;
inline constexpr double kArchRib_mm = 36;    // of the section, in the arch's plane
inline constexpr double kArchDepth_mm = 30;  // of the section, across it
Mesh arch_model();

// Figure 11. Balls and sticks like dimethylzinc, Zn(CH3)2, with its long axis along y and the two
// methyls eclipsed, so that it stands on four hydrogens. 133 mm tall, and together with its support
// over 152.4 mm deep in every layer: four passes of an Objet30's head, which Table 1's 15 h 55 min
// ask for.
inline constexpr double kMoleculeHeight_mm = 133;
inline constexpr double kMoleculeDepth_mm = 175;
inline constexpr double kZincRadius_mm = 12;
inline constexpr double kCarbonRadius_mm = 10;
inline constexpr double kHydrogenRadius_mm = 8.5;
inline constexpr double kStickRadius_mm = 3.5;
Mesh molecule_model();

// Figure 12. A square slab on four square legs at its corners.
inline constexpr double kTableSide_mm = 72;
inline constexpr double kTableHeight_mm = 56;
inline constexpr double kTableTop_mm = 5;
inline constexpr double kTableLeg_mm = 7;
Mesh table_model();

// Figure 13. A large cup, a small one that goes into it, and two crystals that go into that.
// Crystals are eight-sided double pyramids on a small foot.
struct RoundSize {
  double radius_mm = 0;
  double height_mm = 0;
};
inline constexpr RoundSize kLargeCup{20, 34};
inline constexpr RoundSize kSmallCup{14, 26};
inline constexpr double kCupWall_mm = 1.6;  // floor too
inline constexpr RoundSize kLargeCrystal{4.5, 16};
inline constexpr RoundSize kSmallCrystal{4.5, 14};
// Table 1's second group, taken for the same pieces enlarged: it took 5.8 times as long.
inline constexpr double kSecondGroupScale = 2.1;
std::vector<Mesh> group_models(double scale);

// Figure 1. The npm package "bunny", ears up, 138 mm tall; its longest side is given. Throws
// Error{kUnavailable} where the package is not installed.
inline constexpr double kBunnyLongest_mm = 141.6;
Mesh bunny_model();

}  // namespace packmerger::bench
