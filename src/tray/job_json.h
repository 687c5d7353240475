// job.json, as docs/JOB_FOLDER describes it: mm, mm³, g, s.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "model/job.h"
#include "tray/comparison_json.h"

namespace packmerger {

// {"name", "technology", "dialect", "build_mm", "plate_mm", "keep_out_mm",
// "support_angle_deg"}.
nlohmann::json printer_json(const Profile& profile);

// The whole report. Number arrays and keys are those of docs/JOB_FOLDER. Bytes that are not UTF-8
// in a file's name are replaced when it is dumped with report_text().
nlohmann::json job_json(const Job& job);

// Indented by two, ending in a line end. Never throws for strings that are not UTF-8.
std::string report_text(const nlohmann::json& json);

}  // namespace packmerger
