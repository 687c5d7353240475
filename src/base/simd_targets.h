// Which kinds of vectors the SIMD kernels are made for; included before Highway's own headers.
#pragma once

// All that Highway has but those whose length is known only at run time: the kernels hold arrays of
// vectors, which these cannot be in. Processors that have them have NEON as well.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
