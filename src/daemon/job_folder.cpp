#include "daemon/job_folder.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/error.h"

namespace packmerger {
namespace {

using nlohmann::json;

constexpr std::uint64_t kMaxReportBytes = std::uint64_t{64} << 20;
constexpr int kMaxTrays = 10000;

json read_report(const fs::path& folder) {
  const fs::path file = folder / "job.json";
  std::error_code ignored;
  if (!fs::exists(file, ignored))
    throw Error(Fault::kNoInput, folder.string() + " is no job folder: it holds no job.json",
                "Name the folder that packmerger prepare --out wrote.");
  const json report = json::parse(read_file(file, kMaxReportBytes), nullptr, false);
  if (!report.is_object() || report.value("version", json()) != 1)
    throw Error(Fault::kBadInput, file.string() + " is not the report of a job",
                "Prepare the model again.");
  return report;
}

int count_trays(const json& report) {
  int trays = 1;
  for (const json& part : report.at("parts")) trays = std::max(trays, part.at("tray").get<int>());
  if (trays > kMaxTrays)
    throw Error(Fault::kBadInput, "The job has more than 10000 trays", "Prepare the model again.");
  return trays;
}

// Nothing where that way does not fit.
const json* estimate_of(const json& estimates, const std::string& variant) {
  const auto found = estimates.find(variant == kProgramVariant ? "as_is" : variant);
  if (found == estimates.end() || !found->is_object() || !found->value("fits", false))
    return nullptr;
  return &*found;
}

std::optional<double> cost_of(const json& estimates, const std::string& way) {
  const json* estimate = estimate_of(estimates, way);
  if (estimate == nullptr) return std::nullopt;
  const auto cost = estimate->find("cost");
  if (cost == estimate->end() || !cost->is_number()) return std::nullopt;
  return cost->get<double>();
}

}  // namespace

PreparedJob read_prepared(const fs::path& folder) {
  const json report = read_report(folder);
  try {
    PreparedJob job;
    const json& input = report.at("inputs").at(0);
    job.trays = count_trays(report);
    job.title = fs::path(input.at("file").get<std::string>()).stem().string();
    job.input_sha256 = input.at("sha256").get<std::string>();
    job.variant = report.value("variant", "packed");
    job.profile = report.value("profile", json::object()).value("id", "");
    job.seed = report.value("seed", std::int64_t{0});
    for (const json& warning : report.value("warnings", json::array())) {
      if (job.warning.empty()) job.warning = warning.at("text").get<std::string>();
    }
    if (const json* estimate = estimate_of(report.at("estimates"), job.variant)) {
      job.predicted_s = estimate->value("time_s", 0.0);
      job.predicted_by = estimate->value("source", "");
    }
    job.estimates = report.at("estimates").dump(-1, ' ', false, json::error_handler_t::replace);
    return job;
  } catch (const json::exception& error) {
    throw Error(Fault::kBadInput,
                (folder / "job.json").string() + " lacks something: " + error.what(),
                "Prepare the model again.");
  }
}

Profile read_prepared_profile(const fs::path& folder) {
  return read_profile(fs::absolute(folder / "profile.toml").string());
}

bool packing_pays(const PreparedJob& job) {
  const json ways = json::parse(job.estimates, nullptr, false);
  if (job.variant != "packed" || !ways.is_object()) return false;
  const std::optional<double> packed = cost_of(ways, "packed");
  if (!packed) return false;
  for (const char* way : {"as_is", "solid", "hollow"}) {
    const std::optional<double> other = cost_of(ways, way);
    if (other && *other <= *packed) return false;
  }
  return true;
}

std::string doubt_about(const PreparedJob& job) {
  if (job.variant == kProgramVariant) return job.warning;
  return packing_pays(job) ? "" : "packing does not pay";
}

fs::path tray_path(const fs::path& folder, const std::string& stem, int tray,
                   const std::string& extension) {
  return folder / (stem + (tray > 1 ? "-" + std::to_string(tray) : "") + extension);
}

}  // namespace packmerger
