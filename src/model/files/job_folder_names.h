// The names of a job folder's files (docs/JOB_FOLDER), for those who write them and those who read
// them.
#pragma once

#include <string>
#include <string_view>

#include "model/printer.h"

namespace packmerger {

inline constexpr const char* kReportFile = "job.json";
inline constexpr const char* kProfileFile = "profile.toml";
inline constexpr const char* kPictureFile = "preview.png";
inline constexpr const char* kPreviewScene = "preview.glb";
inline constexpr const char* kAssemblyScene = "assembly.glb";
inline constexpr const char* kPageScene = "page.glb";
inline constexpr const char* kPartsFolder = "parts";

inline constexpr const char* kTrayStem = "tray";        // of a tray's documents
inline constexpr const char* kProgramStem = "program";  // of its program

// "parts/07.stl", as job.json names a part's file.
std::string part_file(int id);

// "tray.stl" for tray 1, "tray-2.stl" for tray 2: how every file of one tray is named.
std::string tray_file(const std::string& stem, int tray, const std::string& extension);

// What the printer is given of a tray: "program.gcode", "program-2.x3g", or the profile's document,
// "tray-2.stl".
std::string tray_file(const Profile& profile, int tray);

// "sent-2.progress": how far the printer was told to go in a tray, beside the tray or in the
// daemon's own folder of the job.
std::string progress_file(int tray);

// Whether a job folder may hold a file of this name, itself or (by its bare name) among the parts:
// never a way out of it.
bool is_job_file(std::string_view name);

}  // namespace packmerger
