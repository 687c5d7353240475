#include "daemon/web.h"

#include <cctype>
#include <charconv>
#include <chrono>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/files.h"
#include "daemon/job_file.h"
#include "daemon/web_routes.h"

namespace packmerger {
namespace {

using nlohmann::json;

constexpr std::size_t kMostBody = 4096;  // of a request that is no upload
constexpr std::chrono::seconds kPatience(20);

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

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
       {"Cross-Origin-Opener-Policy", "same-origin"},
       {"Cache-Control", "no-store"}});
}

int status_of(int fault) {
  switch (static_cast<Fault>(fault)) {
    case Fault::kUsage:
    case Fault::kBusy:
      return 409;
    case Fault::kNoInput:
      return 404;
    case Fault::kBadInput:
      return 422;
    default:
      return 500;
  }
}

// What the loop answered, as HTTP tells it.
HttpReply reply_of(const std::string& answer) {
  const json told = json::parse(answer, nullptr, false);
  HttpReply reply;
  if (told.value("ok", false)) {
    reply.body = told["result"].dump() + "\n";
  } else {
    reply.status = status_of(told["error"].value("fault", 0));
    reply.body = json{{"error", told["error"]}}.dump() + "\n";
  }
  return reply;
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

Web::Web(const DaemonConfig& config, const KeyRing& keys, WebQuestions& questions,
         WebEvents& events)
    : config_(config),
      questions_(questions),
      events_(events),
      guard_(config.web.hosts, keys),
      address_(keys.empty() ? "127.0.0.1" : config.web.address) {
  server_ = std::make_unique<HttpServer>(
      address_, config.web.port,
      HttpHandler{[this](const HttpRequest& request) { return plan(request); },
                  [this](HttpRequest& request) { return answer(request); }});
}

Web::~Web() = default;

BodyPlan Web::plan(const HttpRequest& request) {
  const WebRoute route = route_of(request);
  std::optional<HttpReply> refusal = guard_.refused(request, route.access, now_s());
  if (!refusal && route.target == WebTarget::kNone) refusal = no_such_route(route);
  if (refusal) {
    add_safe_headers(*refusal);
    return *refusal;
  }
  if (route.target == WebTarget::kUpload)
    return TakeUpload{config_.state / "uploads", config_.web.most_upload_bytes, true};
  return TakeText{kMostBody};
}

HttpReply Web::answer(HttpRequest& request) {
  HttpReply reply;
  try {
    reply = routed(request);
  } catch (const Error& error) {
    reply = web_error(status_of(error.exit_code()), error.fault(), error.what(), error.hint());
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
      for (const char* key : {"limit", "choice"})
        if (const auto given = request.query.find(key); given != request.query.end())
          verb[key] = number(given->second).value_or(-1);
      if (route.verb.starts_with("jobs.") && !route.id.empty())
        verb["id"] = number(route.id).value_or(0);
      if (route.verb.starts_with("printers.") && !route.id.empty()) verb["name"] = route.id;
      return ask(verb.dump(-1, ' ', false, json::error_handler_t::replace));
    }
    case WebTarget::kUpload:
      return upload(request);
    case WebTarget::kJobFile:
      return file_of_job(route.id, route.file);
    case WebTarget::kEvents:
      return events();
    case WebTarget::kPage:
      return page(request);
    case WebTarget::kNone:
      break;
  }
  return no_such_route(route);
}

HttpReply Web::ask(std::variant<std::string, UploadedJob> question) {
  const auto asked = std::make_shared<WebQuestion>();
  asked->ask = std::move(question);
  std::future<std::string> answer = asked->answer.get_future();
  questions_.push(asked);
  if (answer.wait_for(kPatience) == std::future_status::ready) return reply_of(answer.get());
  return web_error(503, Fault::kBusy, "The daemon is busy", "Try again in a moment.");
}

HttpReply Web::upload(HttpRequest& request) {
  const auto printer = request.form.find("printer");
  if (request.files.size() != 1 || printer == request.form.end())
    return web_error(422, Fault::kUsage, "The form needs one file and the field printer",
                     "curl -F printer=NAME -F file=@model.stl does it.");
  const UploadedFile& file = request.files.front();
  if (kind_of_file(file.name) == FileKind::kUnknown)
    return web_error(415, Fault::kBadInput, "This is nothing that PackMerger takes",
                     "Send a model (STL, OBJ, PLY, OFF, 3MF) or a program (G-code, x3g).");
  const auto at_once = request.form.find("print");
  HttpReply reply = ask(UploadedJob{printer->second, file.name, file.path,
                                    at_once != request.form.end() && at_once->second == "true"});
  if (reply.status == 200) reply.status = 201;
  return reply;
}

HttpReply Web::file_of_job(const std::string& id, const std::string& name) {
  if (!is_job_file(name))
    return web_error(404, Fault::kNoInput, "A job has no such file",
                     "docs/JOB_FOLDER.md lists what a job folder holds.");
  const HttpReply shown = ask(json{{"verb", "jobs.show"}, {"id", number(id).value_or(0)}}.dump());
  if (shown.status != 200) return shown;
  const std::string folder = json::parse(shown.body).value("folder", "");
  if (folder.empty())
    return web_error(404, Fault::kNoInput, "The job is not prepared yet",
                     "Wait until it is ready.");
  const bool is_part = std::isdigit(static_cast<unsigned char>(name.front())) != 0;
  HttpReply reply;
  reply.type = media_type(name);
  reply.file = is_part ? fs::path(folder) / "parts" / name : fs::path(folder) / name;
  return reply;
}

HttpReply Web::events() {
  HttpReply reply;
  reply.type = "text/event-stream";
  reply.next = events_.stream();
  if (!reply.next)
    return web_error(503, Fault::kBusy, "Too many pages watch already", "Close one and try again.");
  return reply;
}

HttpReply Web::page(const HttpRequest& request) const {
  const std::string path = request.path == "/" ? "/index.html" : request.path;
  HttpReply reply;
  reply.type = media_type(path);
  reply.file = config_.web.page / path.substr(1);
  return reply;
}

}  // namespace packmerger
