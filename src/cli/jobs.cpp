#include <fmt/format.h>

#include <memory>

#include "base/time/duration.h"
#include "cli/checks.h"
#include "cli/daemon_verb.h"
#include "cli/verb.h"
#include "job/compare/advice.h"
#include "job/compare/comparison_table.h"
#include "tray/job_json.h"

namespace packmerger::cli {
namespace {

using nlohmann::json;

struct Arguments {
  DaemonArguments daemon;
  std::int64_t id = 0;
  int limit = 100;
  std::string variant;
  std::int64_t before = 0;  // 0: from the newest on
};

void list(const Arguments& arguments) {
  json request = {{"verb", "jobs.list"}, {"limit", arguments.limit}};
  if (arguments.before != 0) request["before"] = arguments.before;
  const json jobs = ask(arguments.daemon, request);
  if (arguments.daemon.json) return print_json(jobs);
  if (jobs.empty()) return fmt::print("There are no jobs.\n");
  std::vector<std::vector<std::string>> rows = {{"JOB", "PRINTER", "MODEL", "STATE", "STATUS"}};
  for (const json& job : jobs)
    rows.push_back({std::to_string(job.at("id").get<std::int64_t>()), text_of(job, "printer"),
                    text_of(job, "name"), text_of(job, "state"), text_of(job, "status")});
  print_table(rows);
}

double gib(double bytes) { return bytes / (1 << 30); }

// What people should know of the disk before it is full.
void tell_storage(const Arguments& arguments) {
  if (arguments.daemon.json) return;
  const json storage = ask_newer(arguments.daemon, "storage");
  if (!storage.is_object()) return;
  if (storage.value("low", false))
    fmt::print(stderr,
               "The disk of the daemon's state folder has only {:.1f} GiB left: make room, or "
               "delete what is not needed (packmerger jobs delete ID).\n",
               gib(storage.value("free_bytes", 0.0)));
  if (const json announced = storage.value("announced", json()); announced.is_object())
    fmt::print(stderr,
               "From {} on the folders of {} ended jobs are deleted (keep_days = {}, keep_jobs = "
               "{}); set these to 0 to keep them as long as there is room.\n",
               time_text(announced.at("from_s")), announced.value("jobs", 0),
               storage.value("keep_days", 0), storage.value("keep_jobs", 0));
}

void print_line(const char* name, const std::string& text) {
  if (!text.empty()) fmt::print("{:<11} {}\n", name, text);
}

// "printing 42 %, line 120 of 300, 0:12:34 elapsed, 0:17:20 left"
std::string print_text(const json& print) {
  std::string text =
      fmt::format("{} {:.0f} %", text_of(print, "stage"), 100 * print.value("fraction", 0.0));
  if (const auto total = print.value("total", 0ULL); total > 0)
    text += fmt::format(", {} {} of {}", text_of(print, "unit"), print.value("done", 0ULL), total);
  text += ", " + duration_text(print.value("elapsed_s", 0.0)) + " elapsed";
  if (const json left = print.value("remaining_s", json()); left.is_number())
    text += ", " + duration_text(left.get<double>()) + " left";
  return text;
}

// Where the figures of somebody else's program come from.
std::string source_text(const json& estimate) {
  return source_named(text_of(estimate, "source")) == EstimateSource::kProgram
             ? "says the program itself"
             : "counted from its moves alone";
}

void print_program(const json& job) {
  print_line("kind", "a program, printed as it is");
  const json estimates = job.value("estimates", json());
  const json estimate = estimates.is_object() ? estimates.value("as_is", json()) : json();
  if (!estimate.is_object()) return;
  std::string text =
      spoken_time(estimate.value("time_s", 0.0)) + " (" + source_text(estimate) + ")";
  if (const json grams = estimate.value("model_g", json()); grams.is_number())
    text +=
        fmt::format(", {:.1f} g, {:.2f} {}", grams.get<double>() + estimate.value("support_g", 0.0),
                    estimate.value("cost", 0.0), text_of(estimate, "currency"));
  print_line("estimate", text);
}

// What finished prints taught, beside the estimate and never within it.
void print_times(const json& job) {
  const json predicted = job.value("predicted_s", json());
  const json printed = job.value("printed_s", json());
  if (printed.is_number()) {
    std::string text = duration_text(printed.get<double>());
    if (predicted.is_number()) text += ", predicted " + duration_text(predicted.get<double>());
    if (const json paused = job.value("paused_s", json()); paused.is_number())
      text += ", and paused for " + duration_text(paused.get<double>());
    print_line("printed", text);
  }
  const json correction = job.value("correction", json());
  if (!correction.is_object() || !predicted.is_number()) return;
  const double seconds = predicted.get<double>();
  print_line("prints here", fmt::format("take {}, so about {} ({} to {}) where {} is predicted",
                                        correction_text(correction),
                                        duration_text(seconds * correction.value("factor", 1.0)),
                                        duration_text(seconds * correction.value("low", 1.0)),
                                        duration_text(seconds * correction.value("high", 1.0)),
                                        duration_text(seconds)));
}

// What the printer is given of each tray. Jobs of earlier versions do not tell.
void print_tray_files(const json& job) {
  if (job.value("trays", 0) == 0) return;
  const json files = job.value("tray_files", json());
  if (!files.is_array()) return print_line("sha256", "of what is sent: not known");
  for (const json& file : files)
    print_line("sha256", text_of(file, "sha256") + " " + text_of(file, "file"));
}

// How the printers were compared, where one of them was proposed.
void print_choice(const json& job) {
  const json choice = job.value("choice", json());
  if (!choice.is_object()) return;
  const json printers = choice.value("printers", json::array());
  fmt::print("\nThe {} of {} printers{}\n", text_of(choice, "prefer"), printers.size(),
             choice.value("chosen", json()).is_null() ? ": none" : " is proposed");
  std::vector<std::vector<std::string>> rows = {
      {"", "PRINTER", "TIME", "WAITS", "READY IN", "COST", "PARTS", "TRAYS", ""}};
  for (const json& one : printers) {
    const std::string name = text_of(one, "printer");
    const std::string mark = name == text_of(choice, "chosen") ? "->" : "";
    if (!one.value("fits", false)) {
      rows.push_back({mark, name, "-", "-", "-", "-", "-", "-", text_of(one, "reason")});
      continue;
    }
    rows.push_back({mark, name, spoken_time(one.value("time_s", 0.0)),
                    spoken_time(one.value("waits_s", 0.0)),
                    spoken_time(one.value("ready_in_s", 0.0)),
                    fmt::format("{:.2f} {}", one.value("cost", 0.0), text_of(one, "currency")),
                    std::to_string(one.value("parts", 0)), std::to_string(one.value("trays", 0)),
                    text_of(one, "trouble")});
  }
  print_table(rows);
}

void print_comparison(const json& job) {
  const json estimates = job.value("estimates", json());
  if (!estimates.is_object()) return;
  const Comparison ways = comparison_of(estimates);
  std::string prepared = text_of(job, "variant");
  if (prepared.empty()) prepared = variant_name(cheapest(ways).value_or(Variant::kPacked));
  const std::string taking =
      fmt::format("packmerger jobs prepare {} --variant", job.value("id", 0));
  fmt::print("\n{}", comparison_table(ways, text_of(job, "printer"), prepared, taking));
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
  if (const json trouble = job.value("trouble", json()); trouble.is_object())
    print_line("trouble", trouble_text(trouble));
  if (const json print = job.value("progress", json());
      print.is_object() && text_of(job, "state") == "sending")
    print_line("print", print_text(print));
  print_line("received", time_text(job.value("received_s", json())));
  print_line("ended", time_text(job.value("ended_s", json())));
  print_line("folder", text_of(job, "folder"));
  if (const json deleted = job.value("deleted_s", json()); deleted.is_number())
    print_line("deleted", time_text(deleted));
  print_tray_files(job);
  if (text_of(job, "kind") != "program") print_line("prepared", text_of(job, "variant"));
  print_line("profile", text_of(job, "profile"));
  if (const json seed = job.value("seed", json()); seed.is_number())
    print_line("seed", std::to_string(seed.get<std::int64_t>()));
  print_line("settings", text_of(job, "settings"));
  print_line("filed", text_of(job, "filed"));
  if (const json same = job.value("same_as", json()); same.is_number())
    print_line("bytes", fmt::format("the same as job {}", same.get<std::int64_t>()));
  print_times(job);
  print_choice(job);
  text_of(job, "kind") == "program" ? print_program(job) : print_comparison(job);
  print_history(job);
}

void change(const Arguments& arguments, const std::string& verb) {
  json request = {{"verb", "jobs." + verb}, {"id", arguments.id}};
  if (verb == "prepare") request["variant"] = arguments.variant;
  const json job = ask(arguments.daemon, request);
  if (arguments.daemon.json) return print_json(job);
  fmt::print("Job {} ({}): {}\n", job.at("id").get<std::int64_t>(), text_of(job, "name"),
             verb == "delete" ? "its folder is being deleted, what is known of it stays"
                              : text_of(job, "status"));
  tell_start(job);
}

}  // namespace

void add_jobs(CLI::App& program) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* verb = program.add_subcommand("jobs", "The daemon's jobs");
  verb->require_subcommand(1);
  const auto action = [&](const std::string& name, const std::string& help) {
    return add_daemon_verb(*verb, name, help, arguments->daemon);
  };
  CLI::App* list_all = action("list", "All jobs that have not ended, then the newest that have");
  list_all->add_option("--limit", arguments->limit, "how many of those that have ended")
      ->check(whole_number(1, 1000))
      ->capture_default_str();
  list_all
      ->add_option("--before", arguments->before,
                   "only jobs that ended before the one of this number")
      ->check(counted_from_one());
  list_all->callback([arguments] {
    list(*arguments);
    tell_storage(*arguments);
    tell_troubles(arguments->daemon);
  });
  const auto with_id = [&](CLI::App* one) {
    one->add_option("ID", arguments->id, "the job's number")->required()->check(counted_from_one());
    return one;
  };
  with_id(action("show", "Everything about one job"))->callback([arguments] { show(*arguments); });
  CLI::App* prepare = with_id(action("prepare", "Has a job's model prepared in another way"));
  prepare->add_option("--variant", arguments->variant, "how: the parts packed, or the whole model")
      ->required()
      ->type_name(fmt::format("{}", fmt::join(variant_names(), "|")))
      ->check(CLI::IsMember(variant_names()).description(""));
  prepare->callback([arguments] { change(*arguments, "prepare"); });
  for (const auto& [name, help] :
       {std::pair{"approve", "Lets a job be printed; also ends a hold"},
        std::pair{"hold", "Keeps a job from being printed until it is approved"},
        std::pair{"first", "Lets a job go before all others that wait"},
        std::pair{"cancel", "Ends a job; a print is stopped in the printer's own way"},
        std::pair{"again", "Makes a new job from one that has ended"},
        std::pair{"delete",
                  "Deletes the folder of a job that has ended; what is known of it stays"}})
    with_id(action(name, help))->callback([arguments, name = std::string(name)] {
      change(*arguments, name);
    });
}

}  // namespace packmerger::cli
