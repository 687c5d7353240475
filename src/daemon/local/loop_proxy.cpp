#include "daemon/local/loop_proxy.h"

#include <nlohmann/json.hpp>
#include <utility>

#include "daemon/local/web_error.h"
#include "daemon/views/reply.h"
#include "delivery/job_file.h"
#include "model/files/file_format.h"

namespace packmerger {
namespace {

using nlohmann::json;

// What the loop answered, as HTTP tells it.
HttpReply reply_of(const std::string& answer) {
  HttpReply reply;
  if (const std::optional<std::string_view> result = result_in(answer)) {
    reply.body = std::string(*result) + "\n";
    return reply;
  }
  const json told = json::parse(answer, nullptr, false);
  reply.status = http_status_of(told["error"].value("fault", 0));
  reply.body = json{{"error", told["error"]}}.dump() + "\n";
  return reply;
}

}  // namespace

int http_status_of(int fault) {
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

std::optional<HttpReply> unwelcome(const std::string& given_name) {
  if (kind_of_file(given_name) != FileKind::kUnknown) return std::nullopt;
  return web_error(415, Fault::kBadInput, kNotTaken, what_is_taken());
}

HttpReply LoopProxy::ask(std::variant<std::string, UploadedJob> question) const {
  const auto asked = std::make_shared<WebQuestion>();
  asked->ask = std::move(question);
  std::future<std::string> answer = asked->answer.get_future();
  questions_.push(asked);
  if (answer.wait_for(patience_) != std::future_status::ready && asked->take_back())
    return web_error(503, Fault::kBusy, "The daemon is busy, and nothing was done",
                     "Try again in a moment.");
  return reply_of(answer.get());
}

HttpReply LoopProxy::take(UploadedJob upload) const {
  if (const std::optional<HttpReply> refusal = unwelcome(upload.name)) return *refusal;
  HttpReply reply = ask(std::move(upload));
  if (reply.status == 200) reply.status = 201;
  return reply;
}

}  // namespace packmerger
