#include "daemon/views/reply.h"

namespace packmerger {
namespace {

constexpr std::string_view kDone = R"({"ok":true,"result":)";  // a reply's beginning

}  // namespace

std::string reply_with(std::string_view result) {
  return std::string(kDone).append(result).append("}");
}

std::optional<std::string_view> result_in(std::string_view reply) {
  if (!reply.starts_with(kDone)) return std::nullopt;
  return reply.substr(kDone.size(), reply.size() - kDone.size() - 1);
}

}  // namespace packmerger
