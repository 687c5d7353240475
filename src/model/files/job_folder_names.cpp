#include "model/files/job_folder_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace packmerger {
namespace {

constexpr std::array kNames = {kReportFile,   kProfileFile,   kPictureFile,
                               kPreviewScene, kAssemblyScene, kPageScene};

bool is_number(std::string_view text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

// Of a file of any tray: "tray" or "tray-2".
bool is_stem(std::string_view text, std::string_view stem) {
  if (!text.starts_with(stem)) return false;
  text.remove_prefix(stem.size());
  return text.empty() || (text.front() == '-' && is_number(text.substr(1)));
}

bool is_program_extension(std::string_view extension) {
  return std::any_of(kDialects.begin(), kDialects.end(), [&](const DialectRow& row) {
    return row.language != nullptr && row.language->extension == extension;
  });
}

}  // namespace

std::string part_file(int id) { return fmt::format("{}/{:02}.stl", kPartsFolder, id); }

std::string tray_file(const std::string& stem, int tray, const std::string& extension) {
  if (tray == 1) return stem + "." + extension;
  return fmt::format("{}-{}.{}", stem, tray, extension);
}

std::string tray_file(const Profile& profile, int tray) {
  if (const ProgramLanguage* language = profile.language())
    return tray_file(kProgramStem, tray, std::string(language->extension));
  return tray_file(kTrayStem, tray, profile.document == HandoffDocument::kTrayStl ? "stl" : "3mf");
}

std::string progress_file(int tray) { return fmt::format("sent-{}.progress", tray); }

bool is_job_file(std::string_view name) {
  if (std::find(kNames.begin(), kNames.end(), name) != kNames.end()) return true;
  const std::size_t dot = name.find('.');
  if (dot == std::string_view::npos) return false;
  const std::string_view stem = name.substr(0, dot);
  const std::string_view extension = name.substr(dot + 1);
  if (is_stem(stem, kProgramStem)) return is_program_extension(extension);
  return (is_stem(stem, kTrayStem) && (extension == "stl" || extension == "3mf")) ||
         (is_number(stem) && extension == "stl");
}

}  // namespace packmerger
