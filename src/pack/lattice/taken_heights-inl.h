// The heights that are free for a part at eight positions at once. Included once for each target of
// Highway, by what scans a whole tray.
#if defined(PACKMERGER_PACK_LATTICE_TAKEN_HEIGHTS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef PACKMERGER_PACK_LATTICE_TAKEN_HEIGHTS_INL_H
#undef PACKMERGER_PACK_LATTICE_TAKEN_HEIGHTS_INL_H
#else
#define PACKMERGER_PACK_LATTICE_TAKEN_HEIGHTS_INL_H
#endif

#include <array>

#include <hwy/highway.h>

#include "pack/lattice/height_bits.h"

HWY_BEFORE_NAMESPACE();
namespace packmerger::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr int kPositions = 8;  // side by side
constexpr hn::CappedTag<std::uint64_t, kPositions> kWords;
using Words = hn::VFromD<decltype(kWords)>;
constexpr int kLanes = static_cast<int>(hn::MaxLanes(kWords));
constexpr int kVectors = kPositions / kLanes;
constexpr std::size_t kRunsOfLook = 8;  // between two looks whether any height is free

// The heights that are taken at eight positions, those that were from the start among them. False
// where that are all. looked: how many of the part's runs that took.
HWY_INLINE bool take(const HeightBits& tray, const BitPart& part, std::ptrdiff_t base,
                     std::array<std::uint64_t, kPositions>& taken, std::size_t& looked) {
  std::array<const std::uint64_t*, HeightBits::kPlanes> planes{};
  for (int k = 0; k < HeightBits::kPlanes; ++k)
    planes[static_cast<std::size_t>(k)] = tray.plane(k) + base;
  const std::ptrdiff_t stride = tray.stride();
  Words heights[kVectors];
  for (int v = 0; v < kVectors; ++v) heights[v] = hn::LoadU(kWords, taken.data() + v * kLanes);
  const Words all = hn::Set(kWords, ~std::uint64_t{0});
  const std::size_t count = part.runs.size();
  for (std::size_t next = 0; next < count;) {
    const std::size_t look = std::min(count, next + kRunsOfLook);
    for (; next < look; ++next) {
      const BitRun& run = part.runs[next];
      const std::uint64_t* words = planes[run.power] + run.y * stride + run.x;
      const int high = run.high - (1 << run.power);
      for (int v = 0; v < kVectors; ++v) {
        const Words word = hn::LoadU(kWords, words + v * kLanes);
        heights[v] = hn::Or(
            heights[v], hn::Or(hn::ShiftRightSame(word, run.low), hn::ShiftRightSame(word, high)));
      }
    }
    Words least = heights[0];
    for (int v = 1; v < kVectors; ++v) least = hn::And(least, heights[v]);
    looked = next;
    if (hn::AllTrue(kWords, hn::Eq(least, all))) return false;
  }
  for (int v = 0; v < kVectors; ++v) hn::StoreU(heights[v], kWords, taken.data() + v * kLanes);
  return true;
}

}  // namespace packmerger::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
