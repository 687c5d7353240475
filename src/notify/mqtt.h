// Keeps the newest of every topic at an MQTT broker (OASIS MQTT 3.1.1; Eclipse Paho), on a
// thread of its own.
#pragma once

#include <optional>
#include <string>
#include <thread>

#include "base/queue.h"
#include "notify/notice.h"
#include "notify/standing.h"

namespace packmerger {

struct MqttLimits {
  double answer_s = 5;  // of the broker: to connect, and for each message
  double retry_s = 5;   // doubled up to a minute; a connection that lasts so long begins anew
};

// Messages are retained, quality of service 1. TOPIC/status is "online" while this is connected,
// and "offline" otherwise, which the broker says by itself (last will). While the broker is away
// only the newest message of every topic is kept; all of them are told again when it is back. What
// fails is told in one line, whether it cannot be reached, drops the connection or takes no
// messages; one that it does not take, though it takes all others, is left out until there is a
// newer one.
class Mqtt {
 public:
  Mqtt(MqttSettings settings, TellLine tell, MqttLimits limits = {});
  Mqtt(const Mqtt&) = delete;
  Mqtt& operator=(const Mqtt&) = delete;
  ~Mqtt();  // says "offline"; takes answer_s at most

  void push(Notice notice) { queue_.push(std::move(notice)); }

  const MqttSettings& settings() const { return settings_; }
  std::optional<Trouble> trouble() const { return standing_.trouble(); }  // from any thread

 private:
  class Session;
  class Keeper;
  void run();

  const MqttSettings settings_;
  const TellLine tell_;
  const MqttLimits limits_;
  Standing standing_;
  Queue<Notice> queue_;
  std::thread thread_;
};

// "tcp://HOST:PORT", or "ssl://HOST:PORT" with tls; ports are 1883 and 8883 where none is given.
std::string mqtt_address(const MqttSettings& settings);

}  // namespace packmerger
