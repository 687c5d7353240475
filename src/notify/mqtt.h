// Keeps the newest of every topic at an MQTT broker (Eclipse Paho), on a thread of its own.
#pragma once

#include <map>
#include <string>
#include <thread>

#include "base/queue.h"
#include "notify/notice.h"

namespace packmerger {

struct MqttLimits {
  double answer_s = 5;  // of the broker: to connect, and for each message
  double retry_s = 5;   // doubled up to a minute
};

// Messages are retained, quality of service 1. TOPIC/status is "online" while this is connected,
// and "offline" otherwise, which the broker says by itself (last will). While the broker is away
// only the newest message of every topic is kept; all of them are told again when it is back.
class Mqtt {
 public:
  Mqtt(MqttSettings settings, TellLine tell, MqttLimits limits = {});
  Mqtt(const Mqtt&) = delete;
  Mqtt& operator=(const Mqtt&) = delete;
  ~Mqtt();  // says "offline"; takes answer_s at most

  void push(Notice notice) { queue_.push(std::move(notice)); }

  const MqttSettings& settings() const { return settings_; }

 private:
  class Session;
  void run();

  const MqttSettings settings_;
  const TellLine tell_;
  const MqttLimits limits_;
  Queue<Notice> queue_;
  std::thread thread_;
};

// "tcp://HOST:PORT", or "ssl://HOST:PORT" with tls; ports are 1883 and 8883 where none is given.
std::string mqtt_address(const MqttSettings& settings);

}  // namespace packmerger
