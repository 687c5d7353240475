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

#include "base/time/backoff.h"
#include "notify/retained_topics.h"

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

// The thread's own: the connection, and what the broker has of it.
class Mqtt::Keeper {
 public:
  explicit Keeper(Mqtt& owner) : owner_(owner) {}

  void take() {
    while (std::optional<Notice> notice = owner_.queue_.try_pop())
      topics_.take(owner_.settings_.topic + "/" + notice->topic, std::move(notice->body));
  }

  void keep_connected() {
    if (session_ && !session_->is_connected()) lose("the connection was lost");
    if (session_ || now_s() < next_s_) return;
    session_.emplace(owner_);
    if (const std::string why = session_->connect(); !why.empty()) return lose(why);
    connected_s_ = now_s();
    topics_.begin();
  }

  void publish() {
    while (session_) {
      const auto* message = topics_.next();
      if (message == nullptr) return has_all();
      const std::string topic = message->first;
      if (session_->publish(topic, message->second.body)) {
        topics_.told(topic);
        continue;
      }
      lose(topics_.refused(topic)
               ? "it does not take the messages of " + topic + ", which are left out"
               : "it does not take its messages");
    }
  }

  double wait_s() const { return session_ ? kLookEvery_s : std::max(0.0, next_s_ - now_s()); }

 private:
  void tell(const std::string& text) {
    if (std::exchange(told_, text) != text)
      owner_.tell_("MQTT broker " + owner_.settings_.broker + ": " + text);
  }

  // A connection that lasted was none of those that fail again and again.
  void lose(const std::string& why) {
    if (connected_s_ > 0 && now_s() - connected_s_ > kLongestRetry_s) failures_ = 0;
    connected_s_ = 0;
    session_.reset();
    const double pause_s =
        std::min(backoff_s(owner_.limits_.retry_s, failures_++), kLongestRetry_s);
    next_s_ = now_s() + pause_s;
    owner_.standing_.failed(why, pause_s);
    tell(why);
  }

  void has_all() {
    if (topics_.leaves_out()) return owner_.standing_.lasts();
    owner_.standing_.works();
    tell("connected");
  }

  Mqtt& owner_;
  RetainedTopics topics_;
  std::optional<Session> session_;
  double connected_s_ = 0;  // 0: it is not
  double next_s_ = 0;
  int failures_ = 0;
  std::string told_;
};

void Mqtt::run() {
  Keeper keeper(*this);
  while (!queue_.closed()) {
    keeper.take();
    keeper.keep_connected();
    keeper.publish();
    pollfd news{queue_.fd(), POLLIN, 0};
    ::poll(&news, 1, static_cast<int>(1000 * keeper.wait_s()) + 1);
  }
  keeper.take();
  keeper.publish();
}

}  // namespace packmerger
