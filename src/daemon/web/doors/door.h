// Doors: the interfaces of OctoPrint, PrusaLink and Moonraker, as far as slicers need them to test
// a connection, to upload, and to see what the printer does. Below /printers/NAME each printer has
// all of them; which one is meant tells the route that is asked (docs/SLICERS.md).
//
// Each door only translates: files go in through LoopProxy::take, requests through LoopProxy::ask.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>

#include "daemon/local/loop_proxy.h"
#include "http/message.h"

namespace packmerger {

// Of OctoPrint, whose interface this is; clients compare them.
inline constexpr const char* kOctoprintVersion = "1.5.0";
inline constexpr const char* kOctoprintApi = "0.1";

struct DoorCall {
  const HttpRequest& request;
  const LoopProxy& loop;
  std::string printer;
  std::string path;  // what stands for {path} in the route: "folder/part.gcode"
};

enum class DoorBody { kText, kForm, kFile };

struct DoorRoute {
  std::string_view method;
  std::string_view pattern;  // below /printers/NAME/; its last segment may be {path}: one or more
  DoorBody body;
  HttpReply (*answer)(const DoorCall&);
};

std::span<const DoorRoute> octoprint_routes();
std::span<const DoorRoute> prusalink_routes();
std::span<const DoorRoute> moonraker_routes();

// What the slicer's user reads, in plain text: Cura shows nothing else, PrusaSlicer shows it as it
// is.
HttpReply door_error(int status, const std::string& text);
// An error of our own interface told that way; other replies stay.
HttpReply in_plain_words(HttpReply reply);

HttpReply door_reply(const nlohmann::json& body, int status = 200);

// The printer as printers.list shows it. Throws Error{kNoInput} where it is not there, Error{kBusy}
// when the daemon does not answer.
nlohmann::json printer_at(const DoorCall& call);
// The job that is printed there now, as jobs.show shows it; null: none.
nlohmann::json job_at(const DoorCall& call);

// "Offline", "Operational", "Starting", "Printing", "Paused", "Cancelling": OctoPrint's words.
std::string door_state(const nlohmann::json& printer);

// The file goes to the printer. wants_print: the client asks to print it, and the printer's
// settings decide whether that needs approval; otherwise it is held until somebody approves it.
HttpReply taken(const DoorCall& call, std::string name, const UploadedFile& file, bool wants_print);
// The one of a form.
HttpReply taken_from_form(const DoorCall& call, bool wants_print);

// "true", "1", "yes", as forms write it.
bool is_yes(const DoorCall& call, const std::string& field);

// Whether a job that was just taken starts without anybody doing anything more.
bool starts_by_itself(const nlohmann::json& job);

}  // namespace packmerger
