// Which route a request takes, and what it asks of the loop.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "daemon/web/web_guard.h"
#include "http/message.h"

namespace packmerger {

enum class WebTarget {
  kVerb,     // a verb of the local socket
  kUpload,   // a model for a printer
  kRules,    // what an upload may be
  kLook,     // a code of look_codes.h for a key that may look
  kJobFile,  // a file of a job's folder
  kEvents,   // server-sent events
  kDoor,     // what slicers ask: doors/doors.h
  kPage,     // a file of the page
  kNone      // there is no such route
};

struct WebRoute {
  WebTarget target = WebTarget::kNone;
  Access access = Access::kOpen;
  std::string verb;       // kVerb: "jobs.approve"
  std::string id;         // of the job, or the printer's name
  std::string file;       // kJobFile: "preview.glb"
  std::string allowed{};  // kNone: the methods that are there; empty where the path itself is not
};

WebRoute route_of(const HttpRequest& request);

// One line of the interface, as docs/API.md and openapi.json show it.
struct WebRouteText {
  std::string method;
  std::string path;  // with {id}, {name} and {file}
  Access access;
};
std::vector<WebRouteText> web_routes();

// "model/gltf-binary" for .glb, and so on; "application/octet-stream" for what is not known.
std::string media_type(const std::string& name);

}  // namespace packmerger
