#include "daemon/web/doors/doors.h"

#include <initializer_list>

#include "base/error.h"
#include "daemon/web/doors/door.h"

namespace packmerger {
namespace {

constexpr std::string_view kPrinters = "/printers/";
constexpr std::size_t kMostText = 4096;

// Where a request leads.
struct DoorMatch {
  const DoorRoute* route = nullptr;
  std::string printer;
  std::string path;     // of {path}
  std::string allowed;  // without a route: the methods that are there
};

// Whether a pattern's segments are those of the path; its {path} takes what is left.
bool matches(std::string_view pattern, const std::string& path, std::string& rest) {
  const std::size_t open = pattern.find("{path}");
  if (open == std::string_view::npos) return path == pattern;
  if (!path.starts_with(pattern.substr(0, open))) return false;
  rest = path.substr(open);
  return !rest.empty() && rest.back() != '/';
}

DoorMatch match_of(const HttpRequest& request) {
  DoorMatch match;
  const std::string rest = request.path.substr(kPrinters.size());
  const std::size_t slash = rest.find('/');
  match.printer = rest.substr(0, slash);
  if (slash == std::string::npos) return match;
  const std::string below = rest.substr(slash + 1);
  for (const auto routes : {octoprint_routes(), prusalink_routes(), moonraker_routes()})
    for (const DoorRoute& route : routes) {
      if (!matches(route.pattern, below, match.path)) continue;
      if (route.method == request.method) {
        match.route = &route;
        return match;
      }
      match.allowed += (match.allowed.empty() ? "" : ", ") + std::string(route.method);
    }
  return match;
}

HttpReply no_such_door(const DoorMatch& match) {
  if (match.allowed.empty())
    return door_error(404, "There is nothing there. docs/SLICERS.md tells what to type.");
  HttpReply reply = door_error(405, "That cannot be done there.");
  reply.headers.emplace_back("Allow", match.allowed);
  return reply;
}

}  // namespace

bool leads_to_door(const std::string& path) { return path.starts_with(kPrinters); }

BodyPlan plan_at_door(const HttpRequest& request, const LoopProxy& loop, const TakeUpload& room) {
  const DoorMatch match = match_of(request);
  if (match.route == nullptr) return no_such_door(match);
  try {
    printer_at({request, loop, match.printer, match.path});
  } catch (const Error& error) {
    return door_error(http_status_of(error.exit_code()), error.what() + (". " + error.hint()));
  }
  if (match.route->body == DoorBody::kText) return TakeText{kMostText};
  TakeUpload upload = room;
  upload.is_form = match.route->body == DoorBody::kForm;
  if (!upload.is_form)
    if (const auto refusal = unwelcome(match.path)) return in_plain_words(*refusal);
  return upload;
}

HttpReply answer_at_door(const HttpRequest& request, const LoopProxy& loop) {
  const DoorMatch match = match_of(request);
  if (match.route == nullptr) return no_such_door(match);
  try {
    return in_plain_words(match.route->answer({request, loop, match.printer, match.path}));
  } catch (const Error& error) {
    return door_error(http_status_of(error.exit_code()), error.what() + (". " + error.hint()));
  }
}

}  // namespace packmerger
