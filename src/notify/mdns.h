// Announces services on the local network through avahi-daemon (mDNS, RFC 6762; DNS-SD, RFC
// 6763), on a thread of its own.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "base/descriptor.h"
#include "notify/notice.h"
#include "notify/standing.h"

namespace packmerger {

struct MdnsService {
  std::string name;  // what people see; cut to 63 bytes, and changed where another has it
  std::uint16_t port = 0;
  std::vector<std::string> txt;  // "key=value"

  bool operator==(const MdnsService&) const = default;
};

// Each is announced as _octoprint._tcp while this lives and avahi-daemon runs. Where it does not
// run that is told once; it is announced again when it is back. That it stops is a trouble; that it
// was never there is none, because it need not be installed.
class Mdns {
 public:
  // retry_s: before D-Bus is tried again where there is none; doubled up to sixteen times.
  Mdns(std::vector<MdnsService> services, TellLine tell, double retry_s = 30);
  Mdns(const Mdns&) = delete;
  Mdns& operator=(const Mdns&) = delete;
  ~Mdns();

  const std::vector<MdnsService>& services() const { return services_; }
  std::optional<Trouble> trouble() const { return standing_.trouble(); }  // from any thread

 private:
  const std::vector<MdnsService> services_;
  const TellLine tell_;
  const double retry_s_;
  Standing standing_;
  Descriptor ending_;  // readable once this is to end
  std::thread thread_;
};

}  // namespace packmerger
