#include "cli/measured_prints.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "base/files.h"
#include "delivery/job_folder.h"
#include "job/compare/unpacked.h"
#include "job/load_models.h"
#include "job/store/correction.h"
#include "model/files/job_folder_names.h"

namespace packmerger::cli {
namespace {

using nlohmann::json;

constexpr std::size_t kJobsAsked = 1000;  // at a time: the most that the daemon tells
constexpr std::uint64_t kMaxReportBytes = std::uint64_t{64} << 20;

[[noreturn]] void refuse(const StatedPrint& print, const std::string& why,
                         const std::string& hint) {
  throw Error(Fault::kBadInput, print.name + " " + why, hint);
}

// What a print of another profile says about this one.
void compare_profiles(const StatedPrint& print, const Profile& used, const Profile& profile,
                      Warnings& warnings) {
  if (used.technology != profile.technology || used.is_sliced() != profile.is_sliced() ||
      taught_estimator_of(used) != taught_estimator_of(profile))
    refuse(print,
           fmt::format("was prepared for {}, whose time is not made up as that of {}", used.id,
                       profile.id),
           fmt::format("Calibrate that profile (packmerger calibrate {}), or leave the print out.",
                       used.id));
  if (!profile.is_sliced() && used.layer_mm != profile.layer_mm)
    refuse(print,
           fmt::format("was prepared in layers of {} mm, and {} has {} mm", used.layer_mm,
                       profile.id, profile.layer_mm),
           "Calibrate a profile with those layers, or leave the print out: what a layer takes "
           "depends on its height.");
  if (used.id != profile.id)
    warnings.push_back({"other_profile", fmt::format("{} was prepared with the profile {}, not {}",
                                                     print.name, used.id, profile.id)});
}

std::vector<Tray> trays_in(const StatedPrint& print, int count, const Progress& progress) {
  const json report = json::parse(read_file(print.path / kReportFile, kMaxReportBytes));
  std::vector<std::filesystem::path> files;
  std::vector<int> places;
  for (const json& part : report.at("parts")) {
    files.push_back(print.path / part.at("file").get<std::string>());
    places.push_back(part.at("tray").get<int>());
  }
  if (files.empty())
    refuse(print, "holds a program that was printed as it is, and no parts to be measured",
           "Name the model it was made of instead.");
  Warnings of_parts;  // small parts are no mistake of a unit
  const std::vector<LoadedModel> parts = load_models(files, {}, of_parts, progress);
  std::vector<Tray> trays(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < parts.size(); ++i)
    trays.at(static_cast<std::size_t>(places[i] - 1)).parts.push_back(*parts[i].surface);
  if (!print.tray) return trays;
  if (*print.tray > count)
    refuse(print, fmt::format("has {} trays, and no tray {}", count, *print.tray),
           "Trays are counted from 1.");
  return {trays[static_cast<std::size_t>(*print.tray - 1)]};
}

PrintTerms terms_of_folder(const Profile& profile, const StatedPrint& print, Warnings& warnings,
                           const Progress& progress) {
  if (print.size_mm || print.scale != 1)
    refuse(print, "is a job folder, which has its size", "Leave --size and --scale out.");
  const PreparedJob job = read_prepared(print.path);
  const Profile used = read_prepared_profile(print.path);
  compare_profiles(print, used, profile, warnings);
  if (!profile.is_sliced())
    return print_terms(profile, trays_in(print, job.trays, progress), progress);
  if (print.tray && job.trays > 1)
    refuse(print, "was sliced, and its figures are sums of its trays",
           "State what all trays took together.");
  if (!(job.predicted_s > 0))
    refuse(print, "says nothing of how long it was predicted to take", "Leave the print out.");
  PrintTerms terms;
  terms.trays = job.trays;
  terms.path_s = std::max(0.0, job.predicted_s - job.trays * used.fdm.start_s);
  return terms;
}

PrintTerms terms_of_model(const Profile& profile, const StatedPrint& print, Warnings& warnings,
                          const Progress& progress) {
  if (print.tray) refuse(print, "is no job folder, and has no trays", "Leave --tray out.");
  Sizing sizing;
  sizing.scale = print.scale;
  sizing.size_mm = print.size_mm;
  const std::vector<LoadedModel> loaded = load_models({print.path}, sizing, warnings, progress);
  const auto standing = stand_as_is({loaded.front().surface}, profile);
  if (!standing)
    refuse(print, fmt::format("does not fit {} as it stands in its file", profile.id),
           "State its size (--size MM), or name the job folder that was printed.");
  return print_terms(profile, trays_of(*standing), progress);
}

// Every job of the daemon, newest first.
std::vector<json> all_jobs(const DaemonArguments& daemon) {
  std::vector<json> jobs;
  json request = {{"verb", "jobs.list"}, {"limit", kJobsAsked}};
  for (;;) {
    const json page = ask(daemon, request);
    jobs.insert(jobs.end(), page.begin(), page.end());
    if (page.size() < kJobsAsked) return jobs;
    request["before"] = jobs.back().at("id");
  }
}

}  // namespace

std::vector<StatedPrint> prints_of_daemon(const Profile& profile, const DaemonArguments& daemon,
                                          const std::string& printer, Warnings& warnings) {
  std::vector<StatedPrint> prints;
  for (const json& job : all_jobs(daemon)) {
    const bool wanted = printer.empty() ? text_of(job, "profile") == profile.id
                                        : text_of(job, "printer") == printer;
    const json printed = job.value("printed_s", json());
    if (!wanted || text_of(job, "state") != "done" || !printed.is_number()) continue;
    if (const json paused = job.value("paused_s", json());
        paused.is_number() && paused.get<double>() >= kLongPause_s)
      continue;
    StatedPrint print;
    print.name = fmt::format("job {} ({})", job.at("id").get<std::int64_t>(), text_of(job, "name"));
    print.path = text_of(job, "folder");
    print.time_s = printed.get<double>();
    std::error_code unreadable;
    if (std::filesystem::exists(print.path / kReportFile, unreadable))
      prints.push_back(std::move(print));
    else
      warnings.push_back(
          {"no_folder",
           fmt::format("{} is left out: its folder {} {}", print.name, print.path.string(),
                       unreadable ? unreadable.message() : "is not there any more")});
  }
  return prints;
}

CalibrationPrint measured_print(const Profile& profile, const StatedPrint& print,
                                Warnings& warnings, const Progress& progress) {
  std::error_code ignored;
  if (!std::filesystem::exists(print.path, ignored))
    throw Error(Fault::kNoInput, "There is no " + print.path.string(),
                "Name a job folder that was printed, or a model file.");
  CalibrationPrint measured;
  measured.name = print.name;
  measured.time_s = print.time_s;
  measured.model_g = print.model_g;
  measured.support_g = print.support_g;
  measured.terms = std::filesystem::is_directory(print.path, ignored)
                       ? terms_of_folder(profile, print, warnings, progress)
                       : terms_of_model(profile, print, warnings, progress);
  return measured;
}

}  // namespace packmerger::cli
