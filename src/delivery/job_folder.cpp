#include "delivery/job_folder.h"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "base/error.h"
#include "base/json_values.h"
#include "delivery/child_json.h"
#include "job/compare/advice.h"
#include "model/files/job_folder_names.h"

namespace packmerger {
namespace {

using nlohmann::json;

constexpr std::uint64_t kMaxReportBytes = std::uint64_t{64} << 20;
constexpr int kMaxTrays = 10000;

json read_report(const fs::path& folder) {
  const fs::path file = folder / kReportFile;
  std::error_code ignored;
  if (!fs::exists(file, ignored))
    throw Error(Fault::kNoInput, folder.string() + " is no job folder: it holds no " + kReportFile,
                "Name the folder that packmerger prepare --out wrote.");
  const json report = parse_child_json(read_file(file, kMaxReportBytes));
  if (!report.is_object() || report.value("version", json()) != 1)
    throw Error(Fault::kBadInput, file.string() + " is not the report of a job",
                "Prepare the model again.");
  return report;
}

int count_trays(const json& report) {
  int trays = 1;
  for (const json& part : report.at("parts"))
    trays = std::max(trays, static_cast<int>(whole_number_in(part, "tray", 1, kMaxTrays)));
  return trays;
}

// Nothing where that way does not fit.
const json* estimate_of(const json& estimates, const std::string& variant) {
  const auto found = estimates.find(variant == kProgramVariant ? "as_is" : variant);
  if (found == estimates.end() || !found->is_object() || !found->value("fits", false))
    return nullptr;
  return &*found;
}

// Of a model that was packed, though another way is better.
std::string doubt_about_packing(const Estimate& packed, const Estimate& other,
                                const std::string& name) {
  const std::string doubt =
      packed.parts == 1 ? "it is in one piece, with nothing to pack" : "packing does not pay";
  const std::string printed = doubt + ": printed " + name;
  if (other.cost > packed.cost) return printed + " it takes less time";
  if (other.cost < packed.cost - kSameCost) return printed + " it costs less";
  return packed.parts == 1 ? doubt : printed + " it costs as little";
}

// The cheapest of what is left need not be the cheapest: a person decides.
std::string doubt_about_refused(const Comparison& ways) {
  for (const Variant way : {Variant::kPacked, Variant::kHollow, Variant::kSolid})
    if (const auto refused = ways.refused.find(variant_name(way)); refused != ways.refused.end())
      return std::string(variant_name(way)) + " could not be compared: " + refused->second.what;
  return {};
}

}  // namespace

PreparedJob read_prepared(const fs::path& folder) {
  const json report = read_report(folder);
  try {
    PreparedJob job;
    const json& input = report.at("inputs").at(0);
    job.trays = count_trays(report);
    check_estimates(report.at("estimates"));
    job.title = fs::path(text_in(input, "file")).stem().string();
    job.input_sha256 = text_in(input, "sha256");
    if (report.contains("variant")) job.variant = text_in(report, "variant");
    if (report.contains("profile")) job.profile = text_in(report.at("profile"), "id");
    if (report.contains("seed"))
      job.seed = whole_number_in(report, "seed", 0, std::numeric_limits<std::int64_t>::max());
    const bool is_model = job.variant != kProgramVariant;
    for (const json& warning : report.value("warnings", json::array())) {
      const std::string code = text_in(warning, "code");
      const bool matters = code == "suspicious_size" || code == "shape_changed";
      // what a Replicator has nothing like harms nobody, nor does a fan that blows more
      const bool asks = is_model ? matters : code != "left_out" && code != "fan_full";
      if (asks && job.warning.empty()) job.warning = text_in(warning, "text");
    }
    if (const json* estimate = estimate_of(report.at("estimates"), job.variant)) {
      job.predicted_s = estimate->value("time_s", 0.0);
      job.predicted_by = estimate->value("source", "");
    }
    job.estimates = json_text(report.at("estimates"));
    return job;
  } catch (const json::exception& error) {
    throw Error(Fault::kBadInput,
                (folder / kReportFile).string() + " lacks something: " + error.what(),
                "Prepare the model again.");
  }
}

Profile read_prepared_profile(const fs::path& folder) {
  return read_profile(fs::absolute(folder / kProfileFile).string());
}

std::string doubt_about(const PreparedJob& job) {
  if (job.variant == kProgramVariant || !job.warning.empty()) return job.warning;
  const std::optional<Comparison> ways = comparison_in(job.estimates);
  const std::optional<Variant> own = variant_named(job.variant);
  if (!ways || !own || !estimate_of(*ways, *own))
    return "prepared " + job.variant + ": what it costs is not known";
  const Estimate& prepared = *estimate_of(*ways, *own);
  if (const std::string unknown = doubt_about_refused(*ways); !unknown.empty()) return unknown;
  const Variant best = *cheapest(*ways);
  if (best == *own) return {};
  const Estimate& other = *estimate_of(*ways, best);
  const std::string name(variant_name(best));
  if (*own == Variant::kPacked) return doubt_about_packing(prepared, other, name);
  return other.cost > prepared.cost - kSameCost
             ? ""
             : "prepared " + job.variant + ": printed " + name + " it costs less";
}

std::string hash_trays(const fs::path& folder, int trays) {
  const Profile profile = read_prepared_profile(folder);
  json files = json::array();
  for (int tray = 1; tray <= trays; ++tray) {
    const std::string file = tray_file(profile, tray);
    files.push_back({{"file", file}, {"sha256", sha256_hex_of_file(folder / file)}});
  }
  return files.dump();
}

std::string hash_of_tray(const std::string& tray_files, int tray) {
  if (tray_files.empty()) return {};
  try {
    return json::parse(tray_files).at(static_cast<std::size_t>(tray) - 1).at("sha256");
  } catch (const json::exception&) {
    throw Error(Fault::kBadInput, "Nothing tells what was prepared of tray " + std::to_string(tray),
                kPrepareAnew);
  }
}

}  // namespace packmerger
