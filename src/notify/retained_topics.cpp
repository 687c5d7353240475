#include "notify/retained_topics.h"

#include <algorithm>
#include <utility>

namespace packmerger {

// One that was refused for good is tried once more for each newer message.
void RetainedTopics::take(const std::string& topic, std::string body) {
  Message& message = topics_[topic];
  message.body = std::move(body);
  message.is_told = message.is_left_out = false;
}

void RetainedTopics::begin() {
  for (auto& [topic, message] : topics_) message.is_told = false;
}

const std::pair<const std::string, RetainedTopics::Message>* RetainedTopics::next() const {
  const std::pair<const std::string, Message>* doubtful = nullptr;
  for (const auto& item : topics_) {
    const Message& message = item.second;
    if (message.is_told || message.is_left_out) continue;
    if (!message.is_doubtful) return &item;
    if (doubtful == nullptr || message.refusals < doubtful->second.refusals) doubtful = &item;
  }
  return doubtful;
}

void RetainedTopics::told(const std::string& topic) {
  Message& message = topics_.at(topic);
  message.is_told = true;
  message.is_doubtful = false;
  message.refusals = 0;
}

bool RetainedTopics::refused(const std::string& topic) {
  Message& message = topics_.at(topic);
  const bool takes_others = std::any_of(topics_.begin(), topics_.end(), [](const auto& item) {
    return item.second.is_told && !item.second.is_doubtful;
  });
  if (message.is_doubtful && takes_others) ++message.refusals;
  message.is_doubtful = true;
  message.is_left_out = message.refusals >= kMostRefusals;
  return message.is_left_out;
}

bool RetainedTopics::leaves_out() const {
  return std::any_of(topics_.begin(), topics_.end(),
                     [](const auto& item) { return item.second.is_left_out; });
}

}  // namespace packmerger
