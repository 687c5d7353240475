// One part put on a tray where others stand, anywhere it is free and can be taken out again.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "model/packing.h"
#include "pack/anywhere/solid_place.h"
#include "pack/anywhere/standing.h"

namespace packmerger {

// The parts of a tray and what they cost.
struct Arranged {
  std::vector<StandingPart> parts;
  double cost = 0;    // Cost::evaluate, support counted on the coarse grid
  double unrest = 0;  // of equal costs the lesser is better: how far up matter lies
};

// coarse: of samples, where places are looked for; fine: of bounds, where parts are put.
// Thread-safe; everything handed in must outlive it.
class PutBack {
 public:
  PutBack(const PackProblem& problem, const std::vector<double>& volumes_mm3, SolidMaker& solids,
          const SolidGrid& coarse, const SolidGrid& fine)
      : problem_(problem),
        volumes_mm3_(volumes_mm3),
        solids_(solids),
        coarse_(coarse),
        fine_(fine) {}

  // The parts as they stand, but all moved down together until one stands on the plate.
  Arranged rated(std::vector<StandingPart> parts);

  // Upper side, units.
  int top(const StandingPart& part) { return part.z + coarse_of(part)->rise; }

  // The cheapest place for a part in one of the attitudes; nothing where the tray then costs more
  // than most_cost, or the part or others would have no way out.
  std::optional<StandingPart> anywhere(
      const std::vector<StandingPart>& rest, int part,
      const std::vector<std::shared_ptr<const Attitude>>& attitudes, double most_cost);

  // The same within two coarse cells of where the part stood, in its attitude.
  std::optional<StandingPart> nearby(const std::vector<StandingPart>& rest,
                                     const StandingPart& part, double most_cost);

 private:
  // Keeps the drawings alive that places point to.
  struct Scene {
    std::vector<std::shared_ptr<const SolidPart>> drawings;
    std::vector<SolidPlace> places;
  };

  Scene fine_scene(const std::vector<StandingPart>& parts);
  Scene coarse_scene(const std::vector<StandingPart>& parts);
  std::shared_ptr<const SolidPart> coarse_of(const StandingPart& part);
  TrayMeasure measure(const SolidTray& tray, const std::vector<StandingPart>& parts) const;
  std::optional<StandingPart> settled(const std::vector<SolidPlace>& rest,
                                      const TrayMeasure& before, const StandingPart& near,
                                      double most_cost);
  double volume(int part) const { return volumes_mm3_[static_cast<std::size_t>(part)]; }

  const PackProblem& problem_;
  const std::vector<double>& volumes_mm3_;  // by part
  SolidMaker& solids_;
  const SolidGrid& coarse_;
  const SolidGrid& fine_;
};

}  // namespace packmerger
