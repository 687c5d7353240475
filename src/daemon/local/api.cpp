#include "daemon/local/api.h"

#include <map>
#include <nlohmann/json.hpp>

#include "base/json_values.h"
#include "daemon/jobs/waits.h"
#include "daemon/keys/look_link.h"
#include "daemon/views/daemon_view.h"
#include "daemon/views/job_view.h"
#include "daemon/views/printer_view.h"
#include "daemon/views/reply.h"
#include "local/client.h"

namespace packmerger {
namespace {

using nlohmann::json;
using Verb = json (*)(JobManager&, const json&);
using Starts = std::optional<JobRecord> (*)(const JobManager&, const json&);
using KeyVerb = json (*)(const WebConfig&, KeyRing&, const json&);

constexpr auto kDefaultJobs = static_cast<std::int64_t>(kLastEnded);
constexpr int kMostJobs = 1000;
constexpr int kMostChoices = 99;

[[noreturn]] void not_understood(const std::string& what) {
  throw Error(Fault::kUsage, what, "docs/DAEMON.md lists the requests.");
}

std::int64_t whole_number(const json& request, const char* key, std::int64_t otherwise) {
  const auto found = request.find(key);
  if (found == request.end()) return otherwise;
  if (!found->is_number_integer()) not_understood(std::string(key) + " must be a whole number");
  return found->get<std::int64_t>();
}

std::int64_t id_of(const json& request) {
  const std::int64_t id = whole_number(request, "id", 0);
  if (id < 1) not_understood("The request needs the job's id");
  return id;
}

std::string name_of(const json& request, const std::string& what = "the printer's name") {
  const auto found = request.find("name");
  if (found == request.end() || !found->is_string()) not_understood("The request needs " + what);
  return found->get<std::string>();
}

// Whatever has not ended, first; then so many of those that have. The last of them asks for the
// next page, which holds only ended ones.
json list_jobs(JobManager& job_manager, const json& request) {
  const std::int64_t limit = whole_number(request, "limit", kDefaultJobs);
  if (limit < 1 || limit > kMostJobs) not_understood("limit must be from 1 to 1000");
  const bool is_first = !request.contains("before");
  const std::int64_t before = whole_number(request, "before", JobStore::kFromTheLast);
  if (before < 1) not_understood("before must be a job's id");
  json jobs = json::array();
  const auto& open = job_manager.store().open_jobs();
  if (is_first)
    for (auto job = open.rbegin(); job != open.rend(); ++job)
      if (!has_ended(job->second.state)) jobs.push_back(job_view(job_manager, job->second));
  for (const JobRecord& job : job_manager.store().newest_ended(static_cast<int>(limit), before))
    jobs.push_back(job_view(job_manager, job));
  return jobs;
}

json show_job(JobManager& job_manager, const json& request) {
  const std::optional<JobRecord> job = job_manager.store().find(id_of(request));
  if (!job)
    throw Error(Fault::kNoInput, "There is no job " + std::to_string(id_of(request)),
                "packmerger jobs list shows them.");
  return job_view_with_history(job_manager, *job);
}

template <JobRecord (JobManager::*act)(std::int64_t)>
json change_job(JobManager& job_manager, const json& request) {
  return job_view(job_manager, (job_manager.*act)(id_of(request)));
}

json prepare_job(JobManager& job_manager, const json& request) {
  const auto variant = request.find("variant");
  if (variant == request.end() || !variant->is_string())
    not_understood("The request needs a variant");
  return job_view(job_manager, job_manager.prepare(id_of(request), variant->get<std::string>()));
}

json list_printers(JobManager& job_manager, const json&) {
  json printers = json::array();
  for (const PrinterConfig& printer : job_manager.config().printers)
    printers.push_back(printer_view(job_manager, printer));
  return printers;
}

json view_of(const JobManager& job_manager, const PrinterRecord& printer) {
  return printer_view(job_manager, *job_manager.config().printer(printer.name));
}

json clear_printer(JobManager& job_manager, const json& request) {
  return view_of(job_manager, job_manager.clear(name_of(request)));
}

template <bool paused>
json pause_printer(JobManager& job_manager, const json& request) {
  return view_of(job_manager, job_manager.pause(name_of(request), paused));
}

json answer_printer(JobManager& job_manager, const json& request) {
  const std::int64_t choice = whole_number(request, "choice", 0);
  if (choice < 0 || choice > kMostChoices) not_understood("choice must be from 0 to 99");
  return view_of(job_manager, job_manager.answer(name_of(request), static_cast<int>(choice)));
}

json stop_printer(JobManager& job_manager, const json& request) {
  return view_of(job_manager, job_manager.stop_at_once(name_of(request)));
}

// What a page shows, in one answer.
json whole_state(JobManager& job_manager, const json& request) {
  return {{"jobs", list_jobs(job_manager, request)},
          {"printers", list_printers(job_manager, request)},
          {"storage", storage_view(job_manager)},
          {"troubles", troubles_view(job_manager)}};
}

const std::map<std::string, Verb, std::less<>>& verbs() {
  static const std::map<std::string, Verb, std::less<>> kVerbs = {
      {"jobs.list", list_jobs},
      {"jobs.show", show_job},
      {"jobs.approve", change_job<&JobManager::approve>},
      {"jobs.hold", change_job<&JobManager::hold>},
      {"jobs.first", change_job<&JobManager::put_first>},
      {"jobs.cancel", change_job<&JobManager::cancel>},
      {"jobs.again", change_job<&JobManager::again>},
      {"jobs.prepare", prepare_job},
      {"jobs.delete", change_job<&JobManager::remove>},
      {"printers.list", list_printers},
      {"storage", [](JobManager& job_manager, const json&) { return storage_view(job_manager); }},
      {"troubles", [](JobManager& job_manager, const json&) { return troubles_view(job_manager); }},
      {"state", whole_state},
      {"printers.clear", clear_printer},
      {"printers.pause", pause_printer<true>},
      {"printers.resume", pause_printer<false>},
      {"printers.answer", answer_printer},
      {"printers.stop", stop_printer},
  };
  return kVerbs;
}

template <std::optional<JobRecord> (*starts)(const JobManager&, std::int64_t)>
std::optional<JobRecord> start_of_job(const JobManager& job_manager, const json& request) {
  return starts(job_manager, id_of(request));
}

template <std::optional<JobRecord> (*starts)(const JobManager&, const std::string&)>
std::optional<JobRecord> start_at_printer(const JobManager& job_manager, const json& request) {
  return starts(job_manager, name_of(request));
}

// The verbs that may start a print at once.
const std::map<std::string, Starts, std::less<>>& starters() {
  static const std::map<std::string, Starts, std::less<>> kStarters = {
      {"jobs.approve", start_of_job<printed_by_approve>},
      {"jobs.again", start_of_job<printed_by_again>},
      {"printers.clear", start_at_printer<printed_by_clear>},
      {"printers.resume", start_at_printer<printed_by_resume>},
  };
  return kStarters;
}

json list_keys(const WebConfig&, KeyRing& keys, const json&) {
  json list = json::array();
  for (const WebKey& key : keys.list())
    list.push_back(
        {{"name", key.name}, {"made_s", key.made_s}, {"may", key.looks_only ? "look" : "change"}});
  return list;
}

json add_key(const WebConfig&, KeyRing& keys, const json& request) {
  const std::string name = name_of(request, "a name");
  return {{"name", name}, {"key", keys.add(name)}};
}

json revoke_key(const WebConfig& web, KeyRing& keys, const json& request) {
  keys.revoke(name_of(request, "a name"));
  return list_keys(web, keys, request);
}

json link_for_page(const WebConfig& web, KeyRing& keys, const json&) {
  if (web.port == 0)
    throw Error(Fault::kUsage, "The web server is off",
                "Set port in the table [web] of the settings, and reload them.");
  return {{"link", look_link(web, keys)}, {"good_for_s", LookCodes::kGoodFor_s}};
}

const std::map<std::string, KeyVerb, std::less<>>& key_verbs() {
  static const std::map<std::string, KeyVerb, std::less<>> kVerbs = {{"keys.list", list_keys},
                                                                     {"keys.add", add_key},
                                                                     {"keys.revoke", revoke_key},
                                                                     {"keys.link", link_for_page}};
  return kVerbs;
}

json error_view(Fault fault, const std::string& what, const std::string& hint) {
  return {{"fault", static_cast<int>(fault)}, {"what", what}, {"hint", hint}};
}

struct Reply {
  json body;
  bool done = true;  // otherwise body tells the error
};

// Who says which print may start, 0 for none, is not surprised by another one.
Reply start_refused(const JobRecord& start) {
  const std::string id = std::to_string(start.id);
  json error = error_view(Fault::kUsage,
                          "This starts job " + id + " at once, on the printer " + start.printer,
                          "Say starts=" + id + " where it may start.");
  error["starts"] = start_view(start);
  return {error, false};
}

Reply reply_to(JobManager& job_manager, KeyRing& keys, std::string_view text) {
  const json request = json::parse(text, nullptr, false);
  if (!request.is_object()) not_understood("The request is not a JSON object on one line");
  const auto name = request.find("verb");
  if (name == request.end() || !name->is_string()) not_understood("The request has no verb");
  const auto key_verb = key_verbs().find(name->get<std::string>());
  if (key_verb != key_verbs().end())
    return {key_verb->second(job_manager.config().web, keys, request)};
  const auto verb = verbs().find(name->get<std::string>());
  if (verb == verbs().end()) not_understood(kUnknownVerb);
  const auto starter = starters().find(verb->first);
  if (starter == starters().end()) return {verb->second(job_manager, request)};
  const std::optional<JobRecord> start = starter->second(job_manager, request);
  if (start && whole_number(request, "starts", start->id) != start->id)
    return start_refused(*start);
  json result = verb->second(job_manager, request);
  result["starts"] = start ? start_view(*start) : json();
  if (start && result.contains("id"))
    result["starts"]["job"] = result["id"];  // again has a new one
  return {result};
}

template <typename Work>
Reply tried(const Work& work) {
  try {
    return work();
  } catch (const Error& error) {
    return {error_view(error.fault(), error.what(), error.hint()), false};
  } catch (const std::exception& error) {
    return {error_view(Fault::kInternal, error.what(), "Look into the daemon's messages."), false};
  }
}

template <typename Work>
std::string answered(const Work& work) {
  const Reply reply = tried(work);
  if (reply.done) return reply_with(json_text(reply.body));
  return json_text({{"ok", false}, {"error", reply.body}});
}

}  // namespace

std::string answer(JobManager& job_manager, KeyRing& keys, std::string_view request) {
  return answered([&] { return reply_to(job_manager, keys, request); });
}

std::string answer_upload(JobManager& job_manager, const UploadedJob& upload) {
  return answered([&] { return Reply{job_view(job_manager, job_manager.uploaded(upload))}; });
}

}  // namespace packmerger
