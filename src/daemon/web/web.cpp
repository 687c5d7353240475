#include "daemon/web/web.h"

#include <cctype>
#include <charconv>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/files.h"
#include "base/json_values.h"
#include "base/time/clock.h"
#include "daemon/local/web_error.h"
#include "daemon/web/doors/door.h"
#include "daemon/web/doors/doors.h"
#include "daemon/web/web_routes.h"
#include "model/files/file_format.h"
#include "model/files/job_folder_names.h"

namespace packmerger {
namespace {

using nlohmann::json;

constexpr std::size_t kMostBody = 4096;  // of a request that is no upload

// A page of ours may load what is ours and nothing else; three.js makes its textures from blobs.
void add_safe_headers(HttpReply& reply) {
  reply.headers.insert(
      reply.headers.end(),
      {{"Content-Security-Policy",
        "default-src 'none'; script-src 'self'; style-src 'self'; font-src 'self'; "
        "img-src 'self' blob: data:; connect-src 'self' blob:; base-uri 'none'; "
        "form-action 'none'; frame-ancestors 'none'"},
       {"X-Content-Type-Options", "nosniff"},
       {"X-Frame-Options", "DENY"},
       {"Referrer-Policy", "no-referrer"},
       {"Cross-Origin-Resource-Policy", "same-origin"},
       {"Cross-Origin-Opener-Policy", "same-origin"}});
}

std::optional<std::int64_t> number(const std::string& text) {
  std::int64_t value = 0;
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (failed != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

HttpReply no_such_route(const WebRoute& route) {
  if (route.allowed.empty())
    return web_error(404, Fault::kNoInput, "There is nothing there",
                     "docs/API.md lists the routes.");
  HttpReply reply = web_error(405, Fault::kUsage, "That cannot be done there",
                              "Use " + route.allowed + "; docs/API.md lists the routes.");
  reply.headers.emplace_back("Allow", route.allowed);
  return reply;
}

}  // namespace

std::filesystem::path uploads_folder(const DaemonConfig& config) {
  return config.state / "uploads";
}

Web::Web(const DaemonConfig& config, KeyRing& keys, WebQuestions& questions, WebEvents& events)
    : config_(config.web),
      uploads_(uploads_folder(config)),
      keys_(keys),
      loop_(questions),
      events_(events),
      guard_(config.web.hosts, keys, config.web.trust_local.value_or(true)),
      address_(keys.empty() ? "127.0.0.1" : config.web.address) {
  server_ = std::make_unique<HttpServer>(
      address_, config.web.port,
      HttpHandler{[this](const HttpRequest& request) { return plan(request); },
                  [this](HttpRequest& request) { return answer(request); }});
}

Web::~Web() = default;

BodyPlan Web::plan(const HttpRequest& request) {
  const WebRoute route = route_of(request);
  std::optional<HttpReply> refusal = guard_.refused(request, route.access, steady_now_s());
  if (!refusal && route.target == WebTarget::kNone) refusal = no_such_route(route);
  if (refusal) guard_.hold_back(*refusal);
  const TakeUpload room{uploads_, config_.most_upload_bytes, true};
  BodyPlan body = TakeText{kMostBody};
  if (refusal)
    body = route.target == WebTarget::kDoor ? in_plain_words(*refusal) : *refusal;
  else if (route.target == WebTarget::kDoor)
    body = plan_at_door(request, loop_, room);
  else if (route.target == WebTarget::kUpload)
    body = room;
  if (auto* reply = std::get_if<HttpReply>(&body)) add_safe_headers(*reply);
  return body;
}

HttpReply Web::answer(HttpRequest& request) {
  HttpReply reply;
  try {
    reply = routed(request);
  } catch (const Error& error) {
    reply = web_error(http_status_of(error.exit_code()), error.fault(), error.what(), error.hint());
  } catch (const std::exception& error) {
    reply = web_error(500, Fault::kInternal, error.what(), "Look into the daemon's messages.");
  }
  add_safe_headers(reply);
  return reply;
}

HttpReply Web::routed(HttpRequest& request) {
  const WebRoute route = route_of(request);
  switch (route.target) {
    case WebTarget::kVerb: {
      json verb = {{"verb", route.verb}};
      for (const char* key : {"limit", "before", "choice", "starts"})
        if (const auto given = request.query.find(key); given != request.query.end())
          verb[key] = number(given->second).value_or(-1);
      if (const auto variant = request.query.find("variant"); variant != request.query.end())
        verb["variant"] = variant->second;
      if (route.verb.starts_with("jobs.") && !route.id.empty())
        verb["id"] = number(route.id).value_or(0);
      if (route.verb.starts_with("printers.") && !route.id.empty()) verb["name"] = route.id;
      return loop_.ask(json_text(verb));
    }
    case WebTarget::kUpload:
      return upload(request);
    case WebTarget::kRules:
      return upload_rules();
    case WebTarget::kJobFile:
      return file_of_job(route.id, route.file);
    case WebTarget::kLook:
      return look(request);
    case WebTarget::kEvents:
      return events(request);
    case WebTarget::kDoor:
      return answer_at_door(request, loop_);
    case WebTarget::kPage:
      return page(request);
    case WebTarget::kNone:
      break;
  }
  return no_such_route(route);
}

HttpReply Web::upload(HttpRequest& request) {
  const auto printer = request.form.find("printer");
  if (request.files.size() != 1 || printer == request.form.end())
    return web_error(422, Fault::kUsage, "The form needs one file and the field printer",
                     "curl -F printer=NAME -F file=@model.stl does it.");
  const UploadedFile& file = request.files.front();
  const auto at_once = request.form.find("print");
  return loop_.take({.printer = printer->second,
                     .name = file.name,
                     .file = file.path,
                     .at_once = at_once != request.form.end() && at_once->second == "true"});
}

HttpReply Web::upload_rules() const {
  json endings = json::array();
  json formats = json::array();
  for (const FileFormat& format : file_formats()) endings.push_back(format.ending);
  for (const bool programs : {false, true})
    for (const std::string_view name : format_names(programs)) formats.push_back(name);
  HttpReply reply;
  reply.body = json{{"most_bytes", config_.most_upload_bytes},
                    {"endings", std::move(endings)},
                    {"formats", std::move(formats)}}
                   .dump() +
               "\n";
  return reply;
}

HttpReply Web::file_of_job(const std::string& id, const std::string& name) {
  if (!is_job_file(name))
    return web_error(404, Fault::kNoInput, "A job has no such file",
                     "docs/JOB_FOLDER.md lists what a job folder holds.");
  const HttpReply shown =
      loop_.ask(json{{"verb", "jobs.show"}, {"id", number(id).value_or(0)}}.dump());
  if (shown.status != 200) return shown;
  const json job = json::parse(shown.body);
  const std::string folder = job.value("folder", "");
  if (folder.empty() && job.value("trays", 0) > 0)
    return web_error(404, Fault::kNoInput, "The job's folder was deleted",
                     "Print it again: it is then prepared anew.");
  if (folder.empty())
    return web_error(404, Fault::kNoInput, "The job is not prepared yet",
                     "Wait until it is ready.");
  const bool is_part = std::isdigit(static_cast<unsigned char>(name.front())) != 0;
  HttpReply reply;
  reply.type = media_type(name);
  reply.file = is_part ? fs::path(folder) / kPartsFolder / name : fs::path(folder) / name;
  reply.keep = Keep::kWhileTheSame;
  return reply;
}

HttpReply Web::look(const HttpRequest& request) {
  const std::optional<std::string> key = keys_.look(request.body, steady_now_s());
  if (!key)
    return web_error(401, Fault::kUsage, "This link was used already, or is too old",
                     "packmerger keys link prints another.");
  HttpReply reply;
  reply.body = json{{"key", *key}, {"may", "look"}}.dump() + "\n";
  return reply;
}

// A stream lasts for hours, and ends with its key.
HttpReply Web::events(const HttpRequest& request) {
  HttpReply reply;
  reply.type = "text/event-stream";
  const auto deltas = request.query.find("deltas");
  if (deltas != request.query.end() && deltas->second == "1")
    reply.next = events_.changes(request.header("Last-Event-ID"));
  else
    reply.next = events_.stream();
  if (!reply.next)
    return web_error(503, Fault::kBusy, "Too many pages watch already", "Close one and try again.");
  if (const std::string key(key_of(request)); !key.empty())
    reply.next = [this, key, next = std::move(reply.next)]() -> std::optional<std::string> {
      std::optional<std::string> text = next();
      return keys_.find(key) ? std::move(text) : std::nullopt;
    };
  return reply;
}

HttpReply Web::page(const HttpRequest& request) const {
  const std::string path = request.path == "/" ? "/index.html" : request.path;
  HttpReply reply;
  reply.type = media_type(path);
  reply.file = config_.page / path.substr(1);
  // the names of those change with what they hold
  reply.keep = path.starts_with("/assets/") ? Keep::kForEver : Keep::kWhileTheSame;
  std::error_code ignored;
  if (request.path == "/" && !fs::exists(reply.file, ignored))
    return web_error(404, Fault::kNoInput, "This daemon was built without its page",
                     "Build it with npm (docs/WEB.md), or use the interface for programs.");
  return reply;
}

}  // namespace packmerger
