// One packing by the packer's own placement (src/pack/drop/place.h) on the reference's maps, so
// that both can be compared on the same ground.
#pragma once

#include <vector>

#include "bench/reference_packing.h"
#include "pack/drop/place.h"

namespace packmerger::bench {

class FastPacker {
 public:
  // The problem must outlive the packer; unit_mm is the reference's.
  FastPacker(const PackProblem& problem, double unit_mm);

  // The reference's maps as the placement reads them; both see samples at the cells' centres.
  std::vector<RotatedPart> laid_out(const std::vector<ReferenceMaps>& maps) const;

  // As ReferencePacker::pack; `waste` stays 0.
  ReferencePacking pack(const std::vector<std::vector<RotatedPart>>& parts,
                        const std::vector<double>& volumes_mm3, const Order& order) const;

 private:
  TraySpec spec_;
};

}  // namespace packmerger::bench
