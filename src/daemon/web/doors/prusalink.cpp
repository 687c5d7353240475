// PrusaLink's API (the OpenAPI document of prusa3d/Prusa-Link-Web), as PrusaSlicer uses it: it asks
// OctoPrint's /api/version, which tells it to upload by PUT.
#include <array>

#include "daemon/web/doors/door.h"

namespace packmerger {
namespace {

using nlohmann::json;

// storage_list must come first: PrusaSlicer looks at the first key.
HttpReply storage(const DoorCall&) {
  const json local = {{"path", "/local"},
                      {"name", "PackMerger"},
                      {"type", "LOCAL"},
                      {"read_only", false},
                      {"available", true}};
  return door_reply({{"storage_list", json::array({local})}});
}

HttpReply put(const DoorCall& call) {
  if (call.request.files.size() != 1) return door_error(400, "The request holds no file.");
  const bool wants_print = call.request.header("Print-After-Upload") == "?1";
  const HttpReply told = taken(call, call.path, call.request.files.front(), wants_print);
  if (told.status != 201) return told;
  const json job = json::parse(told.body);
  return door_reply({{"name", job["name"]},
                     {"display_name", job["name"]},
                     {"type", "PRINT_FILE"},
                     {"job", job["id"]},
                     {"print_started", wants_print && starts_by_itself(job)}},
                    201);
}

constexpr std::array kRoutes = {
    DoorRoute{"GET", "api/v1/storage", DoorBody::kText, storage},
    DoorRoute{"PUT", "api/v1/files/local/{path}", DoorBody::kFile, put},
};

}  // namespace

std::span<const DoorRoute> prusalink_routes() { return kRoutes; }

}  // namespace packmerger
