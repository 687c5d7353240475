// What the value of an option may be. Where it is not, the message says so in words; CLI11's own
// checks name the largest double there is, and let NaN and infinity through.
#pragma once

#include <CLI/CLI.hpp>

#include <cstdint>

namespace packmerger::cli {

CLI::Validator whole_number(std::int64_t low, std::int64_t high);  // both belong to it
CLI::Validator counted_from_one();                                 // 1 or more
CLI::Validator above_zero();                                       // finite
CLI::Validator zero_or_more();                                     // finite

}  // namespace packmerger::cli
