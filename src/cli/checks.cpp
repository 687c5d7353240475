#include "cli/checks.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <functional>
#include <optional>
#include <string>

namespace packmerger::cli {
namespace {

template <typename Number>
std::optional<Number> number_in(const std::string& text) {
  Number value = 0;
  const char* last = text.data() + text.size();
  const auto [end, failed] = std::from_chars(text.data(), last, value);
  if (failed != std::errc() || end != last) return std::nullopt;
  return value;
}

template <typename Number>
CLI::Validator a_number(const std::string& what, const std::string& name,
                        std::function<bool(Number)> holds) {
  return CLI::Validator(
      [what, holds](const std::string& text) {
        const std::optional<Number> value = number_in<Number>(text);
        return value && holds(*value) ? "" : fmt::format("\"{}\" is not {}", text, what);
      },
      name);
}

}  // namespace

CLI::Validator whole_number(std::int64_t low, std::int64_t high) {
  return a_number<std::int64_t>(
      fmt::format("a whole number from {} to {}", low, high), fmt::format("{}-{}", low, high),
      [low, high](std::int64_t value) { return low <= value && value <= high; });
}

CLI::Validator counted_from_one() {
  return a_number<std::int64_t>("a whole number above 0", "",
                                [](std::int64_t value) { return value > 0; });
}

CLI::Validator above_zero() {
  return a_number<double>("a number above 0", "",
                          [](double value) { return std::isfinite(value) && value > 0; });
}

CLI::Validator zero_or_more() {
  return a_number<double>("a number of 0 or more", "",
                          [](double value) { return std::isfinite(value) && value >= 0; });
}

}  // namespace packmerger::cli
