#include "tray/known_ways.h"

#include "base/error.h"
#include "base/files.h"
#include "model/files/job_folder_names.h"
#include "tray/comparison_json.h"
#include "tray/warnings_json.h"

namespace packmerger {
namespace {

using Json = nlohmann::json;

constexpr std::uint64_t kMostBytes = 64 << 20;  // of job.json

ComparedWays compared_of(const Json& json) {
  ComparedWays compared;
  compared.sha256 = json.at("sha256");
  compared.warnings = warnings_of(json.at("warnings"));
  compared.solid_as_is = json.at("solid_as_is");
  compared.packed_apart = json.at("packed_apart");
  return compared;
}

KnownWays known_of(const Json& job) {
  KnownWays known;
  known.compared = compared_of(job.at("compared"));
  known.estimates = comparison_of(job.at("estimates"));
  const Json& segments = job.at("segments");
  known.tetrahedra = segments.at("tetrahedra");
  known.clusters = segments.at("clusters");
  known.after_premerge = segments.at("after_premerge");
  if (const auto tolerance = job.find("resample_tolerance_mm"); tolerance != job.end())
    known.resample_tolerance_mm = tolerance->get<double>();
  return known;
}

}  // namespace

Json compared_json(const ComparedWays& compared) {
  return {{"sha256", compared.sha256},
          {"warnings", warnings_json(compared.warnings)},
          {"solid_as_is", compared.solid_as_is},
          {"packed_apart", compared.packed_apart}};
}

std::optional<KnownWays> known_ways(const fs::path& job_folder) {
  try {
    return known_of(Json::parse(read_file(job_folder / kReportFile, kMostBytes)));
  } catch (const Error&) {
    return std::nullopt;  // deleted meanwhile
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

}  // namespace packmerger
