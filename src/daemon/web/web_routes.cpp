#include "daemon/web/web_routes.h"

#include <algorithm>
#include <array>
#include <sstream>
#include <string_view>

#include "daemon/web/doors/doors.h"
#include "model/files/file_format.h"

namespace packmerger {
namespace {

constexpr std::string_view kApi = "/api/v1/";

struct Row {
  std::string_view method;
  std::string_view path;
  WebTarget target;
  Access access;
  std::string_view verb;
};

constexpr std::array kRows = {
    Row{"GET", "jobs", WebTarget::kVerb, Access::kRead, "jobs.list"},
    Row{"POST", "jobs", WebTarget::kUpload, Access::kChange, ""},
    Row{"GET", "jobs/{id}", WebTarget::kVerb, Access::kRead, "jobs.show"},
    Row{"POST", "jobs/{id}/approve", WebTarget::kVerb, Access::kChange, "jobs.approve"},
    Row{"POST", "jobs/{id}/hold", WebTarget::kVerb, Access::kChange, "jobs.hold"},
    Row{"POST", "jobs/{id}/first", WebTarget::kVerb, Access::kChange, "jobs.first"},
    Row{"POST", "jobs/{id}/cancel", WebTarget::kVerb, Access::kChange, "jobs.cancel"},
    Row{"POST", "jobs/{id}/again", WebTarget::kVerb, Access::kChange, "jobs.again"},
    Row{"POST", "jobs/{id}/prepare", WebTarget::kVerb, Access::kChange, "jobs.prepare"},
    Row{"POST", "jobs/{id}/delete", WebTarget::kVerb, Access::kChange, "jobs.delete"},
    Row{"GET", "jobs/{id}/files/{file}", WebTarget::kJobFile, Access::kRead, ""},
    Row{"GET", "printers", WebTarget::kVerb, Access::kRead, "printers.list"},
    Row{"POST", "printers/{name}/clear", WebTarget::kVerb, Access::kChange, "printers.clear"},
    Row{"POST", "printers/{name}/pause", WebTarget::kVerb, Access::kChange, "printers.pause"},
    Row{"POST", "printers/{name}/resume", WebTarget::kVerb, Access::kChange, "printers.resume"},
    Row{"POST", "printers/{name}/answer", WebTarget::kVerb, Access::kChange, "printers.answer"},
    Row{"POST", "printers/{name}/stop", WebTarget::kVerb, Access::kChange, "printers.stop"},
    Row{"GET", "storage", WebTarget::kVerb, Access::kRead, "storage"},
    Row{"GET", "troubles", WebTarget::kVerb, Access::kRead, "troubles"},
    Row{"GET", "state", WebTarget::kVerb, Access::kRead, "state"},
    Row{"GET", "uploads", WebTarget::kRules, Access::kRead, ""},
    Row{"POST", "look", WebTarget::kLook, Access::kOpen, ""},
    Row{"GET", "events", WebTarget::kEvents, Access::kRead, ""},
};

std::vector<std::string> segments_of(std::string_view path) {
  std::vector<std::string> segments;
  std::istringstream text{std::string(path)};
  for (std::string segment; std::getline(text, segment, '/');) segments.push_back(segment);
  return segments;
}

bool fits(const std::vector<std::string>& pattern, const std::vector<std::string>& path,
          WebRoute& route) {
  if (pattern.size() != path.size()) return false;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (pattern[i] == "{file}")
      route.file = path[i];
    else if (pattern[i].starts_with('{'))
      route.id = path[i];
    else if (pattern[i] != path[i])
      return false;
  }
  return true;
}

}  // namespace

WebRoute route_of(const HttpRequest& request) {
  if (leads_to_door(request.path)) {
    WebRoute door;
    door.target = WebTarget::kDoor;
    door.access = Access::kChange;
    return door;
  }
  if (!request.path.starts_with("/api/")) {
    const bool reads = request.method == "GET";
    return {.target = reads ? WebTarget::kPage : WebTarget::kNone,
            .access = Access::kOpen,
            .verb = {},
            .id = {},
            .file = {},
            .allowed = reads ? "" : "GET"};
  }
  WebRoute none;
  if (!request.path.starts_with(kApi)) return none;
  const std::vector<std::string> path =
      segments_of(std::string_view(request.path).substr(kApi.size()));
  for (const Row& row : kRows) {
    WebRoute route{row.target, row.access, std::string(row.verb), {}, {}, {}};
    if (!fits(segments_of(row.path), path, route)) continue;
    if (row.method == request.method) return route;
    none.allowed += (none.allowed.empty() ? "" : ", ") + std::string(row.method);
  }
  return none;
}

std::vector<WebRouteText> web_routes() {
  std::vector<WebRouteText> routes;
  for (const Row& row : kRows)
    routes.push_back(
        {std::string(row.method), std::string(kApi) + std::string(row.path), row.access});
  return routes;
}

std::string media_type(const std::string& name) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 11> kTypes = {{
      {".html", "text/html; charset=utf-8"},
      {".js", "text/javascript; charset=utf-8"},
      {".css", "text/css; charset=utf-8"},
      {".svg", "image/svg+xml"},
      {".png", "image/png"},
      {".ico", "image/x-icon"},
      {".woff2", "font/woff2"},
      {".json", "application/json"},
      {".glb", "model/gltf-binary"},
      {".toml", "application/toml"},
      {".txt", "text/plain; charset=utf-8"},
  }};
  for (const auto& [ending, type] : kTypes)
    if (name.ends_with(ending)) return std::string(type);
  const FileFormat* format = format_of_name(name);
  if (format != nullptr && !format->media_type.empty()) return std::string(format->media_type);
  return "application/octet-stream";
}

}  // namespace packmerger
