// What a comparison of the ways of printing found out, so that another way can be prepared without
// comparing again.
#pragma once

#include <optional>
#include <string>

#include "model/estimate.h"
#include "model/warning.h"

namespace packmerger {

struct ComparedWays {
  std::string sha256;  // of all that the comparison depends on
  Warnings warnings;   // of all the ways
  // Which way took another's place, because that costs less by the slicer's figures.
  bool solid_as_is = false;   // solid stands as the file does
  bool packed_apart = false;  // packed are the same pieces where they stand unpacked
};

// That, read back from the job that was prepared after it, with what else of it is in job.json.
struct KnownWays {
  ComparedWays compared;
  Comparison estimates;
  int tetrahedra = 0;
  int clusters = 0;
  int after_premerge = 0;
  std::optional<double> resample_tolerance_mm;
};

}  // namespace packmerger
