#include "notify/mqtt.h"

#include <MQTTClient.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <optional>
#include <random>
#include <utility>

namespace packmerger {
namespace {

constexpr int kKeepAlive_s = 20;
constexpr double kLongestRetry_s = 60;
constexpr double kLookEvery_s = 1;  // whether the connection is still there
constexpr int kAtLeastOnce = 1;

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::string client_name() {
  std::random_device random;
  return "packmerger-" + std::to_string(random());
}

}  // namespace

std::string mqtt_address(const MqttSettings& settings) {
  const std::string& broker = settings.broker;
  const std::size_t colon = broker.rfind(':');
  const bool has_port = colon != std::string::npos && broker.find(']', colon) == std::string::npos;
  return (settings.tls ? "ssl://" : "tcp://") + broker +
         (has_port       ? ""
          : settings.tls ? ":8883"
                         : ":1883");
}

// One client of the library; connects once.
class Mqtt::Session {
 public:
  explicit Session(const Mqtt& owner) : owner_(owner), status_(owner.settings_.topic + "/status") {
    MQTTClient_create(&client_, mqtt_address(owner.settings_).c_str(), client_name().c_str(),
                      MQTTCLIENT_PERSISTENCE_NONE, nullptr);
    // with callbacks the library answers the broker on a thread of its own
    MQTTClient_setCallbacks(client_, nullptr, nullptr, ignore, nullptr);
  }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
  ~Session() {
    if (is_connected()) {
      publish(status_, "offline");
      MQTTClient_disconnect(client_, 1000);
    }
    MQTTClient_destroy(&client_);
  }

  bool is_connected() const { return client_ != nullptr && MQTTClient_isConnected(client_) != 0; }

  // Empty: connected. Otherwise why not.
  std::string connect() {
    const MqttSettings& settings = owner_.settings_;
    if (client_ == nullptr) return "its address cannot be used";
    MQTTClient_willOptions will = MQTTClient_willOptions_initializer;
    will.topicName = status_.c_str();
    will.message = "offline";
    will.retained = 1;
    will.qos = kAtLeastOnce;
    MQTTClient_SSLOptions tls = MQTTClient_SSLOptions_initializer;
    tls.verify = 1;
    tls.enableServerCertAuth = 1;
    if (!settings.ca_file.empty()) tls.trustStore = settings.ca_file.c_str();
    MQTTClient_connectOptions options = MQTTClient_connectOptions_initializer;
    options.keepAliveInterval = kKeepAlive_s;
    options.cleansession = 1;
    options.connectTimeout = std::max(1, static_cast<int>(owner_.limits_.answer_s));
    options.will = &will;
    if (!settings.user.empty()) options.username = settings.user.c_str();
    if (!settings.password.empty()) options.password = settings.password.c_str();
    if (settings.tls) options.ssl = &tls;
    const int code = MQTTClient_connect(client_, &options);
    if (code == MQTTCLIENT_SUCCESS)
      return publish(status_, "online") ? "" : "it does not take messages";
    if (code == 4 || code == 5) return "it refuses user and password";
    return settings.tls ? "it cannot be reached, or its certificate is not trusted"
                        : "it cannot be reached";
  }

  // False where the broker did not say that it has it.
  bool publish(const std::string& topic, const std::string& body) {
    MQTTClient_deliveryToken token = 0;
    const auto wait_ms = static_cast<unsigned long>(1000 * owner_.limits_.answer_s);
    return MQTTClient_publish(client_, topic.c_str(), static_cast<int>(body.size()), body.data(),
                              kAtLeastOnce, 1, &token) == MQTTCLIENT_SUCCESS &&
           MQTTClient_waitForCompletion(client_, token, wait_ms) == MQTTCLIENT_SUCCESS;
  }

 private:
  static int ignore(void*, char* topic, int, MQTTClient_message* message) {
    MQTTClient_freeMessage(&message);
    MQTTClient_free(topic);
    return 1;
  }

  const Mqtt& owner_;
  const std::string status_;
  MQTTClient client_ = nullptr;
};

Mqtt::Mqtt(MqttSettings settings, TellLine tell, MqttLimits limits)
    : settings_(std::move(settings)), tell_(std::move(tell)), limits_(limits) {
  thread_ = std::thread([this] { run(); });
}

Mqtt::~Mqtt() {
  queue_.close();
  thread_.join();
}

void Mqtt::run() {
  struct Newest {
    std::string body;
    bool is_told = false;
  };
  std::map<std::string, Newest> topics;
  std::optional<Session> session;
  double next_s = 0;
  double retry_s = limits_.retry_s;
  std::string told;
  const auto tell = [&](const std::string& text) {
    if (std::exchange(told, text) != text) tell_("MQTT broker " + settings_.broker + ": " + text);
  };
  const auto take = [&] {
    while (std::optional<Notice> notice = queue_.try_pop())
      topics[settings_.topic + "/" + notice->topic] = {std::move(notice->body), false};
  };
  const auto connect = [&] {
    session.emplace(*this);
    if (const std::string why = session->connect(); !why.empty()) {
      tell(why);
      session.reset();
      next_s = now_s() + std::exchange(retry_s, std::min(2 * retry_s, kLongestRetry_s));
      return;
    }
    tell("connected");
    retry_s = limits_.retry_s;
    for (auto& [topic, newest] : topics) newest.is_told = false;
  };
  const auto publish = [&] {
    for (auto& [topic, newest] : topics) {
      if (!session || newest.is_told) continue;
      newest.is_told = session->publish(topic, newest.body);
      if (newest.is_told) continue;
      session.reset();
      next_s = now_s() + limits_.retry_s;
    }
  };
  while (!queue_.closed()) {
    take();
    if (session && !session->is_connected()) session.reset();
    if (!session && now_s() >= next_s) connect();
    publish();
    const double wait_s = session ? kLookEvery_s : std::max(0.0, next_s - now_s());
    pollfd news{queue_.fd(), POLLIN, 0};
    ::poll(&news, 1, static_cast<int>(1000 * wait_s) + 1);
  }
  take();
  publish();
}

}  // namespace packmerger
