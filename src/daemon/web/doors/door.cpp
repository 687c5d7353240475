#include "daemon/web/doors/door.h"

#include "base/error.h"
#include "base/json_values.h"

namespace packmerger {
namespace {

using nlohmann::json;

json result_of(const DoorCall& call, const json& request) {
  const HttpReply reply = call.loop.ask(request.dump());
  const json told = json::parse(reply.body, nullptr, false);
  if (reply.status == 200) return told;
  const json error = told.value("error", json::object());
  throw Error(reply.status == 404 ? Fault::kNoInput : Fault::kBusy, error.value("what", ""),
              error.value("hint", ""));
}

}  // namespace

HttpReply door_error(int status, const std::string& text) {
  return {.status = status, .type = "text/plain", .body = text + "\n"};
}

HttpReply in_plain_words(HttpReply reply) {
  if (reply.status < 400 || reply.type != "application/json") return reply;
  const json told = json::parse(reply.body, nullptr, false);
  if (!told.is_object() || !told.contains("error")) return reply;
  const std::string hint = told["error"].value("hint", "");
  reply.type = "text/plain";
  reply.body = told["error"].value("what", "") + "." + (hint.empty() ? "" : " ") + hint + "\n";
  return reply;
}

HttpReply door_reply(const json& body, int status) {
  return {.status = status, .body = json_text(body) + "\n"};
}

json printer_at(const DoorCall& call) {
  for (const json& printer : result_of(call, {{"verb", "printers.list"}}))
    if (printer["name"] == call.printer) return printer;
  throw Error(Fault::kNoInput, "There is no printer of that name",
              "packmerger printers list shows them; the address ends in /printers/NAME.");
}

json job_at(const DoorCall& call) {
  const json job = printer_at(call)["job"];
  return job.is_null() ? job : result_of(call, {{"verb", "jobs.show"}, {"id", job}});
}

std::string door_state(const json& printer) {
  if (!printer["print"].is_null()) {
    const std::string stage = printer["print"].value("stage", "");
    if (stage == "connecting") return "Starting";
    if (stage == "paused") return "Paused";
    if (stage == "cancelling") return "Cancelling";
    return "Printing";
  }
  return printer["connected"] == false ? "Offline" : "Operational";
}

HttpReply taken(const DoorCall& call, std::string name, const UploadedFile& file,
                bool wants_print) {
  return call.loop.take(
      {.printer = call.printer, .name = std::move(name), .file = file.path, .held = !wants_print});
}

HttpReply taken_from_form(const DoorCall& call, bool wants_print) {
  if (call.request.files.size() != 1) return door_error(400, "The form needs exactly one file.");
  const UploadedFile& file = call.request.files.front();
  return taken(call, file.name, file, wants_print);
}

bool is_yes(const DoorCall& call, const std::string& field) {
  const auto given = call.request.form.find(field);
  return given != call.request.form.end() &&
         (given->second == "true" || given->second == "1" || given->second == "yes");
}

bool starts_by_itself(const json& job) {
  return job.value("state", "") == "sending" ||
         (job.value("state", "") == "approved" && job["waits_for"].is_null());
}

}  // namespace packmerger
