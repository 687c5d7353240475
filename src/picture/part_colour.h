// The colours parts have in every picture and scene.
#pragma once

#include "offscreen/offscreen.h"

namespace packmerger {

// Part `index` of a job, from 0: well apart from its neighbours in number, never grey, the same in
// preview.png and the glTF scenes.
Colour part_colour(int index);

// The model before anything was done to it.
Colour model_colour();

}  // namespace packmerger
