#include "tray/program_folder.h"

#include "model/files/job_folder_names.h"
#include "tray/job_json.h"
#include "tray/warnings_json.h"
#include "tray/write_job_folder.h"

namespace packmerger {
namespace {

using Json = nlohmann::json;

Json estimates_json(const ReadyProgram& program) {
  Comparison ways;
  ways.as_is = program.estimate;
  Json estimates = comparison_json(ways);
  if (!program.material_known)
    for (const char* key : {"model_mm3", "model_g", "support_mm3", "support_g", "cost",
                            "material_cost", "machine_cost", "hands_cost"})
      estimates["as_is"][key] = nullptr;
  return estimates;
}

}  // namespace

std::string program_report(const ReadyProgram& program) {
  Json report = {
      {"version", 1},
      {"inputs", {{{"file", program.file}, {"sha256", program.sha256}}}},
      {"profile",
       {{"id", program.profile.id}, {"sha256", sha256_hex(profile_toml(program.profile))}}},
      {"variant", "program"},
      {"printer", printer_json(program.profile)},
      {"program",
       {{"made_by", program.made_by},
        {"bytes", program.bytes.size()},
        {"converted", program.converted}}},
      {"parts", Json::array()},
      {"estimates", estimates_json(program)},
      {"warnings", warnings_json(program.warnings)}};
  return report_text(report);
}

void write_program_folder(const ReadyProgram& program, const fs::path& out) {
  check_job_folder(out);
  TemporaryFolder folder = TemporaryFolder::beside(out);
  write_file_whole(folder.path() / kProfileFile, profile_toml(program.profile));
  write_file_whole(folder.path() / tray_file(kProgramStem, 1, program.extension), program.bytes);
  write_file_whole(folder.path() / kReportFile, program_report(program));
  folder.publish(out);
}

}  // namespace packmerger
