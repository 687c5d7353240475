#include "job/prepare.h"

#include <fmt/format.h>

#include <iostream>
#include <map>
#include <memory>

#include "cli/plan_options.h"
#include "cli/verb.h"
#include "job/comparison_table.h"
#include "tray/job_json.h"

namespace packmerger::cli {
namespace {

struct Arguments {
  PlanArguments plan;
  std::string profile;
  std::string out;
  Variant variant = Variant::kPacked;
  bool json = false;
};

const std::map<std::string, Variant> kVariants{{"packed", Variant::kPacked},
                                               {"hollow", Variant::kHollow},
                                               {"solid", Variant::kSolid},
                                               {"cheapest", Variant::kCheapest}};

void tell(const Job& job, const std::string& out) {
  fmt::print("{}\n{}\n", sizes_of(job), comparison_table(job.estimates, title_of(job.profile)));
  fmt::print("Prepared: {}, {} part{}, {:.1f} mm high, in {}\n", job.variant, job.parts.size(),
             job.parts.size() == 1 ? "" : "s", job.height_mm, out);
  for (const Warning& warning : job.warnings)
    fmt::print(stderr, "warning: {} ({})\n", warning.text, warning.code);
}

void run(const Arguments& arguments) {
  const Profile profile = chosen_profile(arguments.profile, arguments.plan);
  Job job;
  {
    const Progress progress = terminal_progress();
    job =
        prepare(profile, plan_options(arguments.plan), arguments.variant, arguments.out, progress);
  }
  if (arguments.json)
    std::cout << json_text(job_json(job));
  else
    tell(job, arguments.out);
}

}  // namespace

void add_prepare(CLI::App& program) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* verb = program.add_subcommand(
      "prepare", "Prepares models for a printer: writes a job folder that can be sent");
  add_plan_options(*verb, arguments->plan);
  verb->add_option("--profile", arguments->profile, "a profile's id, or the path of a TOML file")
      ->type_name("PROFILE")
      ->required();
  verb->add_option("--out", arguments->out, "the job folder to make; it must not exist")
      ->type_name("FOLDER")
      ->required();
  verb->add_option("--variant", arguments->variant, "what is prepared to be printed")
      ->transform(CLI::CheckedTransformer(kVariants))
      ->default_str("packed");
  verb->add_flag("--json", arguments->json, "prints job.json instead of the table");
  verb->callback([arguments] { run(*arguments); });
}

}  // namespace packmerger::cli
