// What the packer is asked and what it answers (paper, section 6).
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "model/mesh.h"
#include "model/plate.h"
#include "model/segments.h"

namespace packmerger {

// One tray's figures as the search sees them.
struct TrayMeasure {
  Vec3 size_mm = Vec3::Zero();  // the contents' axis-aligned box, z from the tray up; x·y·z = V_bp
  double support_mm3 = 0;       // V_s
  double material_mm3 = 0;
  int parts = 0;
};

// The objective, handed in so that pack knows neither printers nor money.
// lower_bound(m) never exceeds evaluate(n) for any tray n that holds m's contents and more.
// Both are pure and may be called from any thread.
struct Cost {
  std::function<double(const TrayMeasure&)> evaluate;
  std::function<double(const TrayMeasure&)> lower_bound;
};

// The smallest thing the packer moves: a base segment, or a whole model with --no-split.
struct PackItem {
  Mesh surface;           // closed, model coordinates, mm
  double volume_mm3 = 0;  // of matter
  int model = 0;          // index of the input it comes from; items of different models never merge
};

struct PackProblem {
  std::vector<PackItem> items;
  std::vector<SegmentEdge> edges;  // a, b index items; empty: nothing may be merged
  // Each the items round one cavity. Merging never makes a part that holds all of one: it would
  // shut the cavity again, and nobody could take support out of it.
  std::vector<std::vector<int>> enclosures;
  Vec3 build_mm = Vec3::Zero();  // the tray, origin front left, z = 0 the plate
  Plate plate;                   // its walls within build_mm: no part stands over them
  double gap_mm = 1;             // least Euclidean distance between two parts
  double grid_mm = 1;            // cell of the height field in the answer
  double rotation_step = 0;      // radians, about each of the three axes
  double support_angle = 0;      // radians below the horizontal; 0: every down-facing facet
  double search_grid_mm = 3;     // cell of the height field while layouts are searched
  Cost cost;
  int tabu_memory = 3;     // m: rounds a move stays forbidden
  int tabu_patience = 10;  // rounds without a better layout before the search starts afresh
  int tabu_restarts = 2;   // without a better layout before the search ends
  int tabu_samples = 6;    // moves tried in one round
  // After the search, parts are put wherever they fit, in cavities and under overhangs too, with a
  // proven way out. Takes long where parts are large or many.
  bool anywhere = false;
  int most_parts = 0;   // merging goes on until there are no more, if it can; 0: as it pays
  double budget_s = 0;  // 0: until the search ends by itself
  std::uint64_t seed = 1;
};

// A part is a set of items that are printed as one piece.
struct PlacedPart {
  std::vector<int> items;        // sorted indices into PackProblem::items
  Pose pose = Pose::Identity();  // model → tray coordinates, mm
  int tray = 0;                  // from 0
};

struct Packing {
  std::vector<PlacedPart> parts;   // in the order they were placed: bottom first on each tray
  std::vector<int> removal_order;  // indices into parts, first out first
  // By part: translations, mm, in tray coordinates, that come before it is lifted straight up;
  // empty for parts that are lifted at once.
  std::vector<std::vector<Vec3>> removal_paths;
  std::vector<TrayMeasure> trays;
  double cost = 0;  // sum over the trays of Cost::evaluate
};

}  // namespace packmerger
