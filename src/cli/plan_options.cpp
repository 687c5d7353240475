#include "cli/plan_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <map>

#include "base/error.h"
#include "base/names.h"
#include "cli/checks.h"
#include "model/files/file_format.h"

namespace packmerger::cli {
namespace {

const std::map<std::string, double> kUnits{{"mm", 1}, {"cm", 10}, {"m", 1000}, {"in", 25.4}};

constexpr int kMostCopies = 1000;

}  // namespace

void add_plan_options(CLI::App& verb, PlanArguments& arguments) {
  verb.add_option("MODEL", arguments.models,
                  model_format_names(" or ") + "; several share the tray")
      ->required();
  verb.add_option("--copies", arguments.copies, "of each model; they share the trays")
      ->check(whole_number(1, kMostCopies))
      ->capture_default_str();
  verb.add_option("--units", arguments.units, "what the file's numbers are, where it does not say")
      ->check(CLI::IsMember({"mm", "cm", "m", "in"}))
      ->capture_default_str();
  CLI::Option* scale =
      verb.add_option("--scale", arguments.scale, "multiplies the model, on top of its unit")
          ->check(above_zero());
  verb.add_option("--size", arguments.size_mm, "scales the longest side to this many mm")
      ->check(above_zero())
      ->excludes(scale);
  verb.add_flag("--no-split", arguments.no_split,
                "packs the models as they are: neither hollowed nor divided");
  verb.add_flag("--no-hollow", arguments.no_hollow, "keeps the models solid");
  verb.add_option("--seed", arguments.seed, "repeats a result; another seed gives another one")
      ->capture_default_str();
  verb.add_option("--budget", arguments.budget_s, "seconds for the packing; 0: until it is done")
      ->check(zero_or_more())
      ->capture_default_str();
  verb.add_option("--set", arguments.settings, "any setting of the profile")
      ->type_name("KEY=VALUE")
      ->take_all();
}

PlanOptions plan_options(const PlanArguments& arguments) {
  PlanOptions options;
  for (const std::string& model : arguments.models)
    options.models.insert(options.models.end(), static_cast<std::size_t>(arguments.copies), model);
  options.sizing.unit_mm = kUnits.at(arguments.units);
  options.sizing.scale = arguments.scale;
  options.sizing.size_mm = arguments.size_mm;
  options.split = !arguments.no_split;
  options.hollow = !arguments.no_hollow;
  options.seed = arguments.seed;
  options.budget_s = arguments.budget_s;
  return options;
}

void check_profile_given(bool given) {
  if (given) return;
  const std::vector<std::string> ids = profile_ids();
  throw Error(Fault::kUsage, "No printer was named",
              fmt::format("Name one with --profile: {}{}the path of a TOML file.",
                          fmt::join(ids, ", "), ids.empty() ? "" : ", or "));
}

Profile chosen_profile(const std::string& id_or_path, const PlanArguments& arguments) {
  Profile profile = read_profile(id_or_path);
  for (const std::string& assignment : arguments.settings) set_profile_key(profile, assignment);
  check_settings(profile);
  return profile;
}

std::string sizes_of(const Job& job) {
  std::string text;
  for (std::size_t i = 0; i < job.inputs.size();) {
    std::size_t next = i;
    while (next < job.inputs.size() && job.inputs[next].sha256 == job.inputs[i].sha256) ++next;
    const std::string copies = next - i > 1 ? fmt::format(", {} copies", next - i) : "";
    const Vec3 size = bounding_box(job.models[i]).sizes();
    text += fmt::format("{}: {:.1f} x {:.1f} x {:.1f} mm{}\n", printable(job.inputs[i].file),
                        size.x(), size.y(), size.z(), copies);
    i = next;
  }
  return text;
}

std::string title_of(const Profile& profile) { return profile.name + " (" + profile.id + ")"; }

}  // namespace packmerger::cli
