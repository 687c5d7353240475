#include "model/estimate.h"

#include <array>

namespace packmerger {
namespace {

constexpr std::array<std::string_view, 4> kSources = {"model", "slicer", "program", "moves"};

}  // namespace

std::string_view source_name(EstimateSource source) {
  return kSources.at(static_cast<std::size_t>(source));
}

EstimateSource source_named(std::string_view name) {
  for (std::size_t i = 0; i < kSources.size(); ++i)
    if (kSources[i] == name) return static_cast<EstimateSource>(i);
  return EstimateSource::kModel;
}

}  // namespace packmerger
