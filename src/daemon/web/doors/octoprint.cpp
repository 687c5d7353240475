// OctoPrint's REST API (docs.octoprint.org, "REST API"), as PrusaSlicer, OrcaSlicer and Cura use
// it.
#include <array>

#include "base/error.h"
#include "daemon/web/doors/door.h"
#include "http/path.h"

namespace packmerger {
namespace {

using nlohmann::json;

HttpReply version(const DoorCall&) {
  return door_reply({{"api", kOctoprintApi},
                     {"server", kOctoprintVersion},
                     {"text", "OctoPrint (PackMerger " PACKMERGER_VERSION ")"},
                     {"capabilities", {{"upload-by-put", true}}}});
}

HttpReply server(const DoorCall&) {
  return door_reply(
      {{"version", kOctoprintVersion}, {"server", kOctoprintVersion}, {"safemode", nullptr}});
}

// Whoever is here came with a key: there are no other users.
HttpReply user(const DoorCall&) {
  return door_reply({{"name", "_api"},
                     {"active", true},
                     {"user", true},
                     {"admin", false},
                     {"apikey", nullptr},
                     {"permissions", json::array()},
                     {"groups", json::array({"users"})},
                     {"_is_external_client", false},
                     {"_login_mechanism", "apikey"}});
}

HttpReply settings(const DoorCall&) {
  return door_reply({{"api", {{"enabled", true}}},
                     {"feature", {{"sdSupport", false}, {"temperatureGraph", false}}},
                     {"plugins", json::object()},
                     {"webcam", {{"webcamEnabled", false}, {"streamUrl", ""}}}});
}

HttpReply profiles(const DoorCall& call) {
  const json printer = printer_at(call);
  const json profile = {
      {"id", "_default"},   {"name", printer["name"]}, {"model", printer["profile"]},
      {"color", "default"}, {"default", true},         {"current", true}};
  return door_reply({{"profiles", {{"_default", profile}}}});
}

// "tool" → "tool0", "tool 1" → "tool1".
json temperatures(const json& print) {
  json all = json::object();
  if (print.is_null()) return all;
  for (const json& heater : print["heaters"]) {
    std::string name = heater["name"];
    if (name == "tool") name = "tool0";
    std::erase(name, ' ');
    all[name] = {{"actual", heater["actual_c"]}, {"target", heater["target_c"]}, {"offset", 0}};
  }
  return all;
}

HttpReply printer_state(const DoorCall& call) {
  const json printer = printer_at(call);
  const std::string state = door_state(printer);
  if (state == "Offline") return door_error(409, "The printer is not connected.");
  const bool printing = state == "Printing" || state == "Starting";
  return door_reply({{"temperature", temperatures(printer["print"])},
                     {"sd", {{"ready", false}}},
                     {"state",
                      {{"text", state},
                       {"flags",
                        {{"operational", true},
                         {"paused", state == "Paused"},
                         {"printing", printing},
                         {"cancelling", state == "Cancelling"},
                         {"pausing", false},
                         {"resuming", false},
                         {"finishing", false},
                         {"sdReady", false},
                         {"error", false},
                         {"ready", state == "Operational"},
                         {"closedOrError", false}}}}}});
}

json or_nothing(const json& object, const char* key) {
  return object.is_object() && object.contains(key) ? object[key] : json();
}

// A file as these clients know it: by its name alone, or by none.
json named_file(const json& name) {
  return {{"name", name},
          {"display", name},
          {"path", name},
          {"origin", name.is_null() ? json() : json("local")}};
}

HttpReply job_state(const DoorCall& call) {
  const json printer = printer_at(call);
  const json job = job_at(call);
  const json& print = printer["print"];
  json file = named_file(or_nothing(job, "name"));
  file["size"] = file["date"] = nullptr;
  json completion;
  if (print.is_object()) completion = 100 * print.value("fraction", 0.0);
  return door_reply({{"job",
                      {{"file", file},
                       {"estimatedPrintTime", nullptr},
                       {"filament", nullptr},
                       {"lastPrintTime", nullptr},
                       {"user", nullptr}}},
                     {"progress",
                      {{"completion", completion},
                       {"filepos", or_nothing(print, "done")},
                       {"printTime", or_nothing(print, "elapsed_s")},
                       {"printTimeLeft", or_nothing(print, "remaining_s")},
                       {"printTimeOrigin", nullptr}}},
                     {"state", door_state(printer)}});
}

HttpReply done(const HttpReply& reply) {
  return reply.status == 200 ? HttpReply{.status = 204, .body = {}} : reply;
}

// {"command": …} of a request; empty where there is none.
std::string command_of(const json& body) {
  return body.is_object() && body.contains("command") && body["command"].is_string()
             ? body["command"].get<std::string>()
             : "";
}

// Prints here are started by approval, never by a slicer's start button.
HttpReply control_job(const DoorCall& call) {
  const json body = json::parse(call.request.body, nullptr, false);
  const std::string command = command_of(body);
  if (command != "pause" && command != "cancel" && command != "start" && command != "restart")
    return door_error(400, "The commands are pause and cancel.");
  if (command == "start" || command == "restart")
    return door_error(409, "Prints are started by approval in PackMerger.");
  const json printer = printer_at(call);
  if (printer["print"].is_null()) return door_error(409, "Nothing is being printed.");
  if (command == "cancel")
    return done(call.loop.ask(json{{"verb", "jobs.cancel"}, {"id", printer["job"]}}.dump()));
  std::string action = "toggle";
  if (body.contains("action") && body["action"].is_string())
    action = body["action"].get<std::string>();
  const bool stands = door_state(printer) == "Paused";
  const bool pauses = action == "pause" || (action != "resume" && !stands);
  return done(call.loop.ask(json{
      {"verb", pauses ? "printers.pause" : "printers.resume"},
      {"name", call.printer}}.dump()));
}

std::string resource_of(const DoorCall& call, const std::string& name) {
  return "/printers/" + percent_encoded(call.printer) + "/api/files/local/" + percent_encoded(name);
}

json file_view(const DoorCall& call, const json& job) {
  json file = named_file(job["name"]);
  file["job"] = job["id"];
  file["refs"] = {{"resource", resource_of(call, job["name"])}};
  return file;
}

HttpReply upload(const DoorCall& call) {
  const bool wants_print = is_yes(call, "print");
  const HttpReply told = taken_from_form(call, wants_print);
  if (told.status != 201) return told;
  const json job = json::parse(told.body);
  HttpReply reply = door_reply({{"files", {{"local", file_view(call, job)}}},
                                {"done", true},
                                {"effectiveSelect", false},
                                {"effectivePrint", wants_print && starts_by_itself(job)}},
                               201);
  reply.headers.emplace_back("Location", resource_of(call, job["name"]));
  return reply;
}

// The newest job of that name here: names are all that these clients know.
json job_named(const DoorCall& call) {
  const HttpReply jobs = call.loop.ask(R"({"verb": "jobs.list", "limit": 1000})");
  const json list = json::parse(jobs.body, nullptr, false);
  const json* newest = nullptr;
  if (jobs.status == 200)
    for (const json& job : list)
      if (job["printer"] == call.printer && job["name"] == call.path &&
          (newest == nullptr || job["id"] > (*newest)["id"]))
        newest = &job;
  if (newest != nullptr) return *newest;
  throw Error(Fault::kNoInput, "There is no file of that name", "Upload it again.");
}

HttpReply file(const DoorCall& call) {
  json view = file_view(call, job_named(call));
  view["type"] = "machinecode";
  return door_reply(view);
}

HttpReply command_file(const DoorCall& call) {
  const json body = json::parse(call.request.body, nullptr, false);
  if (command_of(body) != "select") return door_error(400, "The only command is select.");
  const json job = job_named(call);
  if (!body.contains("print") || body["print"] != true) return {.status = 204, .body = {}};
  const bool has_doubt = job["state"] == "ready" && job["pays"] != true;  // no slicer shows it
  if (printer_at(call)["approve"] != "auto" || has_doubt)
    return door_error(409, "Job " + job["id"].dump() + " waits for approval in PackMerger.");
  if (job["held"] != true) return {.status = 204, .body = {}};
  return done(call.loop.ask(json{{"verb", "jobs.approve"}, {"id", job["id"]}}.dump()));
}

constexpr std::array kRoutes = {
    DoorRoute{"GET", "api/version", DoorBody::kText, version},
    DoorRoute{"GET", "api/server", DoorBody::kText, server},
    DoorRoute{"POST", "api/login", DoorBody::kText, user},
    DoorRoute{"GET", "api/currentuser", DoorBody::kText, user},
    DoorRoute{"GET", "api/settings", DoorBody::kText, settings},
    DoorRoute{"GET", "api/printerprofiles", DoorBody::kText, profiles},
    DoorRoute{"GET", "api/printer", DoorBody::kText, printer_state},
    DoorRoute{"GET", "api/job", DoorBody::kText, job_state},
    DoorRoute{"POST", "api/job", DoorBody::kText, control_job},
    DoorRoute{"POST", "api/files/local", DoorBody::kForm, upload},
    DoorRoute{"GET", "api/files/local/{path}", DoorBody::kText, file},
    DoorRoute{"POST", "api/files/local/{path}", DoorBody::kText, command_file},
};

}  // namespace

std::span<const DoorRoute> octoprint_routes() { return kRoutes; }

}  // namespace packmerger
