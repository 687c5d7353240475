// Moonraker's HTTP API (moonraker.readthedocs.io, "External API"), as slicers use it to test a
// connection and to upload.
#include <array>

#include "daemon/web/doors/door.h"

namespace packmerger {
namespace {

using nlohmann::json;

HttpReply info(const DoorCall& call) {
  const bool is_there = door_state(printer_at(call)) != "Offline";
  return door_reply({{"result",
                      {{"klippy_connected", is_there},
                       {"klippy_state", is_there ? "ready" : "disconnected"},
                       {"components", json::array()},
                       {"failed_components", json::array()},
                       {"registered_directories", json::array({"gcodes"})},
                       {"warnings", json::array()},
                       {"websocket_count", 0},
                       {"moonraker_version", "PackMerger " PACKMERGER_VERSION},
                       {"api_version", {1, 0, 0}},
                       {"api_version_string", "1.0.0"}}}});
}

HttpReply upload(const DoorCall& call) {
  const auto root = call.request.form.find("root");
  if (root != call.request.form.end() && root->second != "gcodes")
    return door_error(400, "Files go to the root gcodes.");
  const bool wants_print = is_yes(call, "print");
  const HttpReply told = taken_from_form(call, wants_print);
  if (told.status != 201) return told;
  const json job = json::parse(told.body);
  const bool starts = wants_print && starts_by_itself(job);
  return door_reply({{"item",
                      {{"path", job["name"]},
                       {"root", "gcodes"},
                       {"size", call.request.files.front().bytes},
                       {"permissions", "r"}}},
                     {"print_started", starts},
                     {"print_queued", !starts},
                     {"action", "create_file"},
                     {"job", job["id"]}},
                    201);
}

constexpr std::array kRoutes = {
    DoorRoute{"GET", "server/info", DoorBody::kText, info},
    DoorRoute{"POST", "server/files/upload", DoorBody::kForm, upload},
};

}  // namespace

std::span<const DoorRoute> moonraker_routes() { return kRoutes; }

}  // namespace packmerger
