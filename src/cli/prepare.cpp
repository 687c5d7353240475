#include "job/prepare.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iostream>
#include <map>
#include <memory>
#include <optional>

#include "base/names.h"
#include "cli/late_stop.h"
#include "cli/plan_options.h"
#include "cli/verb.h"
#include "delivery/ready_program.h"
#include "job/compare/comparison_table.h"
#include "model/files/file_format.h"
#include "tray/job_json.h"
#include "tray/known_ways.h"
#include "tray/write_job_folder.h"

namespace packmerger::cli {
namespace {

struct Arguments {
  PlanArguments plan;
  std::string profile;
  std::string out;
  Variant variant = Variant::kPacked;
  std::string compared;
  bool json = false;
};

std::map<std::string, Variant> variants() {
  std::map<std::string, Variant> all;
  for (const std::string& name : variant_names()) all.emplace(name, *variant_named(name));
  return all;
}

void tell(const Job& job, const std::string& out) {
  fmt::print("{}\n{}\n", sizes_of(job),
             comparison_table(job.estimates, title_of(job.profile), job.variant));
  fmt::print("Prepared: {}, {} part{}, {:.1f} mm high, in {}\n", job.variant, job.parts.size(),
             job.parts.size() == 1 ? "" : "s", job.height_mm, out);
  for (const Warning& warning : job.warnings)
    fmt::print(stderr, "warning: {} ({})\n", printable(warning.text), warning.code);
}

// Options that make sense for a ready program; the others are about models.
constexpr std::array<std::string_view, 6> kOfPrograms = {"MODEL", "--profile", "--out",
                                                         "--set", "--json",    "--help"};

void check_alone(const Arguments& arguments, const CLI::App& verb) {
  if (arguments.plan.models.size() > 1)
    throw Error(Fault::kUsage, "A program is printed as it is, alone on its tray",
                "Prepare it by itself.");
  for (const CLI::Option* option : verb.get_options())
    if (option->count() > 0 &&
        std::find(kOfPrograms.begin(), kOfPrograms.end(), option->get_name()) == kOfPrograms.end())
      throw Error(Fault::kUsage,
                  "A program is printed as it is: " + option->get_name() + " is for models",
                  "Leave it away, or name the model.");
}

void take_as_it_is(const Arguments& arguments, const Profile& profile) {
  check_job_folder(arguments.out);
  ReadyProgram program;
  {
    const LateStop late_stop;
    const Progress progress = terminal_progress();
    program = read_ready_program(profile, arguments.plan.models.front(), progress);
    write_program_folder(program, arguments.out);
  }
  if (arguments.json) {
    std::cout << program_report(program);
    return;
  }
  fmt::print("{}", told_of(program));
  for (const Warning& warning : program.warnings)
    fmt::print(stderr, "warning: {} ({})\n", printable(warning.text), warning.code);
}

void run(const Arguments& arguments, const CLI::App& verb) {
  check_profile_given(!arguments.profile.empty());
  const Profile profile = chosen_profile(arguments.profile, arguments.plan);
  const auto& models = arguments.plan.models;
  if (std::any_of(models.begin(), models.end(),
                  [](const auto& name) { return is_program(name); })) {
    check_alone(arguments, verb);
    return take_as_it_is(arguments, profile);
  }
  Job job;
  {
    const LateStop late_stop;
    const Progress progress = terminal_progress();
    std::optional<KnownWays> known;
    if (!arguments.compared.empty()) known = known_ways(arguments.compared);
    job = prepare(profile, plan_options(arguments.plan), arguments.variant, arguments.out, progress,
                  known);
  }
  if (arguments.json)
    std::cout << report_text(job_json(job));
  else
    tell(job, arguments.out);
}

}  // namespace

void add_prepare(CLI::App& program) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* verb = program.add_subcommand("prepare",
                                          "Prepares models for a printer: writes a job folder that "
                                          "can be sent; a program (G-code, x3g) "
                                          "is checked and taken as it is");
  add_plan_options(*verb, arguments->plan);
  verb->add_option("--profile", arguments->profile, "a profile's id, or the path of a TOML file")
      ->type_name("PROFILE");
  verb->add_option("--out", arguments->out, "the job folder to make; it must not exist")
      ->type_name("FOLDER")
      ->required();
  verb->add_option("--variant", arguments->variant,
                   "what is prepared to be printed: the parts packed, the whole model hollow or "
                   "solid, or the cheapest of these")
      ->transform(CLI::CheckedTransformer(variants()).description(""))
      ->type_name(fmt::format("{}", fmt::join(variant_names(), "|")))
      ->default_str("packed");
  verb->add_option("--compared", arguments->compared,
                   "a job folder whose comparison is taken where it is of the same model, profile "
                   "and options; otherwise the ways are compared anew")
      ->type_name("FOLDER");
  verb->add_flag("--json", arguments->json, "prints job.json instead of the table");
  verb->callback([arguments, verb] { run(*arguments, *verb); });
}

}  // namespace packmerger::cli
