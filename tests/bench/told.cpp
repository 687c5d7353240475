#include "bench/told.h"

#include <fmt/format.h>

#include <iostream>

namespace packmerger::bench {

void print_told(const nlohmann::ordered_json& told, bool as_json) {
  if (as_json)
    std::cout << told.dump(2) << '\n';
  else
    for (const auto& [key, value] : told.items()) fmt::print("{:<20} {}\n", key, value.dump());
}

LoadedModel load_model(const std::filesystem::path& file, double size_mm) {
  Warnings warnings;
  Sizing sizing;
  sizing.size_mm = size_mm;
  return load_models({file}, sizing, warnings, Progress()).front();
}

}  // namespace packmerger::bench
