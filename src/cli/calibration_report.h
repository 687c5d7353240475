// What `calibrate` found, as people, programs and profiles read it.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "job/calibrate/calibrate.h"
#include "model/profile/derived_profile.h"

namespace packmerger::cli {

// Tables on standard output: the constants, and for each quantity every print as it was seen, as
// predicted before and after, and by a fit to all the others.
void print_calibration(const Calibration& calibration);

nlohmann::json calibration_json(const Calibration& calibration);

// The profile that was fitted, a comment beside each constant. Without a base it holds every key.
// date: "2026-03-01"; id: what the file will be called.
std::string calibrated_toml(const Calibration& calibration, const std::optional<ProfileBase>& base,
                            std::size_t prints, const std::string& date, const std::string& id);

}  // namespace packmerger::cli
