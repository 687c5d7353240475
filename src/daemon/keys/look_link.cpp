#include "daemon/keys/look_link.h"

#include "base/time/clock.h"

namespace packmerger {

std::string look_link(const WebConfig& web, KeyRing& keys) {
  const bool is_one = web.address != "0.0.0.0" && web.address != "::" && web.address != "127.0.0.1";
  const std::string host = keys.empty() || !is_one ? "localhost" : web.address;
  const bool is_six = host.find(':') != std::string::npos;
  return "http://" + (is_six ? "[" + host + "]" : host) + ":" + std::to_string(web.port) +
         "/#look=" + keys.add_code(steady_now_s());
}

}  // namespace packmerger
