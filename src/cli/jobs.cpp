#include <fmt/format.h>

#include <memory>

#include "cli/daemon_verb.h"
#include "cli/verb.h"
#include "job/comparison_table.h"
#include "tray/job_json.h"

namespace packmerger::cli {
namespace {

using nlohmann::json;

struct Arguments {
  DaemonArguments daemon;
  std::int64_t id = 0;
  int limit = 100;
};

void list(const Arguments& arguments) {
  const json jobs = ask(arguments.daemon, {{"verb", "jobs.list"}, {"limit", arguments.limit}});
  if (arguments.daemon.json) return print_json(jobs);
  if (jobs.empty()) return fmt::print("There are no jobs.\n");
  std::vector<std::vector<std::string>> rows = {{"JOB", "PRINTER", "MODEL", "STATE", "STATUS"}};
  for (const json& job : jobs)
    rows.push_back({std::to_string(job.at("id").get<std::int64_t>()), text_of(job, "printer"),
                    text_of(job, "name"), text_of(job, "state"), text_of(job, "status")});
  print_table(rows);
}

void print_line(const char* name, const std::string& text) {
  if (!text.empty()) fmt::print("{:<10} {}\n", name, text);
}

void print_history(const json& job) {
  fmt::print("\n");
  for (const json& event : job.value("history", json::array()))
    fmt::print("{}  {:<12} {}\n", time_text(event.value("at_s", json())), text_of(event, "state"),
               text_of(event, "note"));
}

void show(const Arguments& arguments) {
  const json job = ask(arguments.daemon, {{"verb", "jobs.show"}, {"id", arguments.id}});
  if (arguments.daemon.json) return print_json(job);
  fmt::print("Job {}: {}\n", job.at("id").get<std::int64_t>(), text_of(job, "name"));
  print_line("printer", text_of(job, "printer"));
  print_line("state", text_of(job, "state"));
  print_line("status", text_of(job, "status"));
  print_line("hint", text_of(job, "hint"));
  print_line("received", time_text(job.value("received_s", json())));
  print_line("ended", time_text(job.value("ended_s", json())));
  print_line("folder", text_of(job, "folder"));
  print_line("model", text_of(job, "filed"));
  const json estimates = job.value("estimates", json());
  if (estimates.is_object())
    fmt::print("\n{}", comparison_table(comparison_of(estimates), text_of(job, "printer")));
  print_history(job);
}

void change(const Arguments& arguments, const std::string& verb) {
  const json job = ask(arguments.daemon, {{"verb", "jobs." + verb}, {"id", arguments.id}});
  if (arguments.daemon.json) return print_json(job);
  fmt::print("Job {} ({}): {}\n", job.at("id").get<std::int64_t>(), text_of(job, "name"),
             text_of(job, "status"));
}

}  // namespace

void add_jobs(CLI::App& program) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* verb = program.add_subcommand("jobs", "The daemon's jobs");
  verb->require_subcommand(1);
  const auto action = [&](const std::string& name, const std::string& help) {
    return add_daemon_verb(*verb, name, help, arguments->daemon);
  };
  CLI::App* list_all = action("list", "The newest jobs, what they do and what they wait for");
  list_all->add_option("--limit", arguments->limit, "how many")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  list_all->callback([arguments] { list(*arguments); });
  const auto with_id = [&](CLI::App* one) {
    one->add_option("ID", arguments->id, "the job's number")
        ->required()
        ->check(CLI::PositiveNumber);
    return one;
  };
  with_id(action("show", "Everything about one job"))->callback([arguments] { show(*arguments); });
  for (const auto& [name, help] :
       {std::pair{"approve", "Lets a job be printed; also ends a hold"},
        std::pair{"hold", "Keeps a job from being printed until it is approved"},
        std::pair{"cancel", "Ends a job; a print is stopped in the printer's own way"},
        std::pair{"again", "Makes a new job from one that has ended"}})
    with_id(action(name, help))->callback([arguments, name = std::string(name)] {
      change(*arguments, name);
    });
}

}  // namespace packmerger::cli
