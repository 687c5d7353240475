#include <fmt/format.h>

#include <iostream>
#include <memory>

#include "base/names.h"
#include "cli/late_stop.h"
#include "cli/plan_options.h"
#include "cli/verb.h"
#include "job/compare/advice.h"
#include "job/compare/comparison_table.h"
#include "job/plan.h"
#include "tray/job_json.h"

namespace packmerger::cli {
namespace {

struct Arguments {
  PlanArguments plan;
  std::vector<std::string> profiles;
  bool json = false;
};

void run(const Arguments& arguments) {
  check_profile_given(!arguments.profiles.empty());
  std::vector<Profile> profiles;
  for (const std::string& name : arguments.profiles)
    profiles.push_back(chosen_profile(name, arguments.plan));
  nlohmann::json all = nlohmann::json::object();
  std::vector<Job> jobs;
  {
    const LateStop late_stop;
    const Progress progress = terminal_progress();
    for (const Profile& profile : profiles)
      jobs.push_back(plan(profile, plan_options(arguments.plan), progress).job);
  }
  if (!arguments.json) fmt::print("{}\n", sizes_of(jobs.front()));
  for (const Job& job : jobs) {
    all[job.profile.id] = comparison_json(job.estimates);
    const Advice told = advice(job.estimates);
    all[job.profile.id]["advice"] =
        advice_json(told.variant ? variant_name(*told.variant) : "", told.text);
    if (!arguments.json) fmt::print("{}\n", comparison_table(job.estimates, title_of(job.profile)));
    for (const Warning& warning : job.warnings)
      fmt::print(stderr, "warning: {} ({})\n", printable(warning.text), warning.code);
  }
  if (arguments.json) std::cout << report_text(all);
}

}  // namespace

void add_compare(CLI::App& program) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* verb = program.add_subcommand(
      "compare", "Compares the ways of printing: as the file stands, solid, hollow, packed");
  add_plan_options(*verb, arguments->plan);
  verb->add_option("--profile", arguments->profiles, "a profile's id or path; may be given again")
      ->type_name("PROFILE")
      ->take_all();
  verb->add_flag("--json", arguments->json, "prints {profile id: estimates, and advice}");
  verb->callback([arguments] { run(*arguments); });
}

}  // namespace packmerger::cli
