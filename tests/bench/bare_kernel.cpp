#include "bench/bare_kernel.h"

#include "base/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bench/bare_kernel.cpp"
#include <hwy/foreach_target.h>  // includes this file once for each target

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace packmerger::bench::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void bare_fall(const std::int16_t* field, std::span<const BareCell> cells, std::int16_t* heights) {
  constexpr hn::CappedTag<std::int16_t, kBarePositions> kLanes;
  constexpr int kStep = static_cast<int>(hn::MaxLanes(kLanes));
  constexpr int kVectors = kBarePositions / kStep;
  hn::VFromD<decltype(kLanes)> height[kVectors];
  for (int v = 0; v < kVectors; ++v) height[v] = hn::LoadU(kLanes, heights + v * kStep);
  for (const BareCell& cell : cells) {
    const auto value = hn::Set(kLanes, cell.value);
    for (int v = 0; v < kVectors; ++v)
      height[v] = hn::Max(
          height[v], hn::SaturatedSub(hn::LoadU(kLanes, field + cell.offset + v * kStep), value));
  }
  for (int v = 0; v < kVectors; ++v) hn::StoreU(height[v], kLanes, heights + v * kStep);
}

}  // namespace packmerger::bench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace packmerger::bench {

HWY_EXPORT(bare_fall);

void bare_fall(const std::int16_t* field, std::span<const BareCell> cells, std::int16_t* heights) {
  HWY_DYNAMIC_DISPATCH(bare_fall)(field, cells, heights);
}

}  // namespace packmerger::bench
#endif  // HWY_ONCE
