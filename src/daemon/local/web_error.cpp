#include "daemon/local/web_error.h"

#include <nlohmann/json.hpp>

#include "base/json_values.h"

namespace packmerger {

HttpReply web_error(int status, Fault fault, const std::string& what, const std::string& hint) {
  const nlohmann::json body = {
      {"error", {{"fault", static_cast<int>(fault)}, {"what", what}, {"hint", hint}}}};
  HttpReply reply;
  reply.status = status;
  reply.body = json_text(body) + "\n";
  return reply;
}

}  // namespace packmerger
