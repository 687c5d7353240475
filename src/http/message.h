// What an HTTP request (RFC 9110) asks and what is answered, as plain values.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace packmerger {

// One file of a form, or the whole body of a PUT, as it lies on the disk now.
struct UploadedFile {
  std::string field;  // the form's; empty for a whole body
  std::string name;   // as the client calls it: any bytes, never to be used as a path
  std::filesystem::path path;
  std::uint64_t bytes = 0;
};

struct HttpRequest {
  std::string method;                        // "GET"
  std::string path;                          // decoded; each segment is not empty, "." or ".."
  std::map<std::string, std::string> query;  // decoded
  std::vector<std::pair<std::string, std::string>> headers;
  std::string peer;         // the client's numeric address
  bool is_loopback = true;  // the client runs on this machine

  std::string body;                         // with TakeText
  std::map<std::string, std::string> form;  // with TakeUpload: the fields that are no files
  std::vector<UploadedFile> files;          // with TakeUpload

  // The header's value; empty where it is missing. Names are compared without case.
  std::string_view header(std::string_view name) const;
};

// What a client may keep of a file. One that it keeps while it is the same has a tag, and who has
// it already is told so (304) without being sent it again.
enum class Keep { kNothing, kWhileTheSame, kForEver };

struct HttpReply {
  int status = 200;
  std::string type = "application/json";
  std::string body = {};
  std::vector<std::pair<std::string, std::string>> headers = {};
  // Sent instead of the body: a file (never a link), or what `next` gives until it gives nothing;
  // `next` may wait some seconds for more, and is called on the connection's own thread.
  std::filesystem::path file = {};
  Keep keep = Keep::kNothing;
  std::function<std::optional<std::string>()> next = {};
};

// What is done with a request's body, decided when its headers are there.
struct TakeText {
  std::size_t most_bytes = 0;  // more is answered with 413
};
// Files are written below `folder` as they come, under names of the server's own.
struct TakeUpload {
  std::filesystem::path folder;
  std::uint64_t most_bytes = 0;
  bool is_form = true;  // otherwise the whole body is the file
};
using BodyPlan = std::variant<HttpReply, TakeText, TakeUpload>;

}  // namespace packmerger
