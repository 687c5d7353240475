#include "daemon/workers/worker.h"

#include <fmt/format.h>
#include <signal.h>

#include <charconv>
#include <chrono>

#include "base/names.h"
#include "base/process/process.h"
#include "delivery/child_json.h"
#include "delivery/job_folder.h"

namespace packmerger {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kReportEvery{100};
constexpr std::size_t kMaxReason = 2000;  // bytes of a child's message that are kept

// Where a child that was killed leaves what it was writing.
void remove_leftovers(const fs::path& out, const fs::path& temporary) {
  std::error_code ignored;
  fs::remove_all(temporary, ignored);
  const std::string prefix = "." + out.filename().string() + ".";
  std::vector<fs::path> left;
  for (const fs::directory_entry& entry : fs::directory_iterator(out.parent_path(), ignored))
    if (entry.path().filename().string().starts_with(prefix)) left.push_back(entry.path());
  for (const fs::path& path : left) fs::remove_all(path, ignored);
}

// What a child is told, and what its progress counts for.
struct ChildOrder {
  const PrepareOrder& order;
  const std::vector<std::string>& argv;
  std::string stage;  // before the child's own; empty: its own alone
};

ProcessResult run_child(const ChildOrder& child, const fs::path& temporary, Queue<Event>& events) {
  const PrepareOrder& order = child.order;
  ProcessSpec spec;
  spec.argv = child.argv;
  spec.set_env = {{"TMPDIR", temporary.string()}};
  spec.folder = temporary;
  spec.nice = order.limits.nice;
  spec.max_memory_bytes = order.limits.memory_bytes;
  spec.only_writable = {order.out.parent_path()};
  Clock::time_point told = Clock::now() - kReportEvery;
  const auto on_line = [&](std::string_view text) {
    const std::optional<ProgressLine> line = progress_line(text);
    if (!line || Clock::now() - told < kReportEvery) return;
    told = Clock::now();
    events.push(PrepareProgress{order.job, child.stage + line->stage, line->fraction});
  };
  return run_process(spec, order.limits.time_s, Progress({}, order.cancel.get()), on_line);
}

void check_result(const ProcessResult& result, double time_s) {
  if (result.timed_out)
    throw Error(Fault::kBadInput,
                fmt::format("Preparing took longer than {:g} s and was ended", time_s),
                "Simplify the model, or raise time_s below [prepare] in the daemon's settings.");
  if (result.status.ok()) return;
  const Failure failure = child_failure(result.status.code, result.status.signal, result.err);
  throw Error(failure.fault, failure.what, failure.hint);
}

fs::path clean_temporary(const PrepareOrder& order) {
  const fs::path temporary = order.out.parent_path() / "tmp";
  remove_leftovers(order.out, temporary);
  fs::create_directories(temporary);
  return temporary;
}

// A child may write below its job's folder, and what it leaves there is read later, by us and by
// others: a link would lead out of it, and a pipe would keep its reader waiting for ever.
void check_only_files(const fs::path& folder) {
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    const fs::file_status status = entry.symlink_status();
    if (!fs::is_regular_file(status) && !fs::is_directory(status))
      throw Error(Fault::kBadInput,
                  "Preparing left something that is no file: " +
                      printable(entry.path().filename().string()),
                  "Drop the model again; if that does not help, report it as a bug.");
  }
}

// A printer that a model cannot be printed on is told with the others.
Compared compare(const PrepareOrder& order, Queue<Event>& events) {
  events.push(Hashed{order.job, sha256_hex_of_file(order.input)});
  const fs::path temporary = clean_temporary(order);
  Compared compared{order.job, {}};
  for (const CompareOrder& each : order.compare) {
    ComparedPrinter printer{each.printer, each.variant, "", ""};
    try {
      const ProcessResult result =
          run_child({order, each.argv, each.printer + ": "}, temporary, events);
      check_result(result, order.limits.time_s);
      printer.estimates = compared_estimates(result.out);
    } catch (const Error& error) {
      if (error.fault() == Fault::kInterrupted) throw;
      printer.failure = error.what();
    }
    compared.printers.push_back(std::move(printer));
  }
  return compared;
}

Prepared prepare(const PrepareOrder& order, Queue<Event>& events) {
  const std::string sha256 = sha256_hex_of_file(order.input);
  events.push(Hashed{order.job, sha256});
  const fs::path temporary = clean_temporary(order);
  check_result(run_child({order, order.argv, ""}, temporary, events), order.limits.time_s);
  remove_leftovers(order.out, temporary);
  check_only_files(order.out.parent_path());
  const PreparedJob job = read_prepared(order.out);
  if (job.input_sha256 != sha256)
    throw Error(Fault::kBusy, "The model was changed while it was being read",
                "Drop it again once the program that writes it has finished.");
  return {order.job,        job.trays,
          job.estimates,    job.profile,
          job.seed,         job.variant,
          job.predicted_s,  job.predicted_by,
          doubt_about(job), hash_trays(order.out, job.trays)};
}

Event prepare_or_fail(const PrepareOrder& order, Queue<Event>& events) {
  try {
    if (!order.compare.empty()) return compare(order, events);
    return prepare(order, events);
  } catch (const Error& error) {
    return PrepareFailed{order.job, {error.fault(), error.what(), error.hint()}};
  } catch (const std::exception& error) {
    return PrepareFailed{order.job,
                         {Fault::kInternal, error.what(), "Look into the daemon's messages."}};
  }
}

}  // namespace

std::optional<ProgressLine> progress_line(std::string_view line) {
  const std::size_t close = line.find("%] ");
  if (line.empty() || line.front() != '[' || close == std::string_view::npos) return std::nullopt;
  std::string_view digits = line.substr(1, close - 1);
  digits.remove_prefix(std::min(digits.find_first_not_of(' '), digits.size()));
  int percent = 0;
  const auto [end, failed] = std::from_chars(digits.begin(), digits.end(), percent);
  if (failed != std::errc() || end != digits.end() || percent < 0 || percent > 100)
    return std::nullopt;
  return ProgressLine{printable(line.substr(close + 3, 200)), percent / 100.0};
}

Failure child_failure(int exit_code, int signal, std::string_view standard_error) {
  Failure failure;
  while (!standard_error.empty()) {
    const std::size_t end = std::min(standard_error.find('\n'), standard_error.size());
    const std::string_view line = standard_error.substr(0, std::min(end, kMaxReason));
    standard_error.remove_prefix(std::min(end + 1, standard_error.size()));
    if (line.starts_with("error: ")) failure.what = printable(line.substr(7));
    if (line.starts_with("hint: ")) failure.hint = printable(line.substr(6));
  }
  for (const Fault fault : {Fault::kUsage, Fault::kBadInput, Fault::kNoInput, Fault::kUnavailable,
                            Fault::kCannotWrite, Fault::kIo, Fault::kBusy, Fault::kBadProfile})
    if (signal == 0 && static_cast<int>(fault) == exit_code) failure.fault = fault;
  if (signal != 0) {
    failure.what = fmt::format("Preparing ended in a crash ({})", ::strsignal(signal));
    failure.hint =
        "Repair the model in another program and drop it again; if the machine is short "
        "of memory, lower memory_bytes or give it more.";
  }
  if (failure.what.ends_with('.')) failure.what.pop_back();
  if (failure.what.empty())
    failure.what = fmt::format("Preparing failed with exit code {} and said nothing", exit_code);
  if (failure.hint.empty()) failure.hint = "Run packmerger prepare on the model to see more.";
  return failure;
}

void run_worker(Queue<PrepareOrder>& orders, Queue<Event>& events) {
  while (const std::optional<PrepareOrder> order = orders.pop()) {
    Event end = prepare_or_fail(*order, events);
    remove_leftovers(order->out, order->out.parent_path() / "tmp");
    events.push(std::move(end));  // last: whoever hears of it may use the folder
  }
}

}  // namespace packmerger
