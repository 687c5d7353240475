// A layout made lower while its parts may turn and move freely: it is squeezed a little, and the
// parts moved apart again, over and over.
#pragma once

#include <functional>
#include <vector>

#include "pack/separate/separation.h"

namespace packmerger {

// Judges a lower layout: false sends the compression back to the last one that it was content with.
using IsAccepted = std::function<bool(const std::vector<Pose>& poses, double height_mm)>;

// poses: a layout that separate() made, or one that keeps what it promises; the lowest accepted one
// afterwards. Ends after `patience` failures or refusals one after the other, or when is_over
// says so. The judge is asked after kJudged_mm of height each time, and at the end.
void compress(const Separation& separation, std::vector<Pose>& poses, int patience,
              const std::function<bool()>& is_over, const IsAccepted& is_accepted, Random& random);

}  // namespace packmerger
