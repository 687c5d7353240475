#include "notify/retained_topics.h"

#include <gtest/gtest.h>

namespace packmerger {
namespace {

// What a broker gets that takes nothing from these topics, and drops the connection where it is
// given one.
std::string told_until_it_drops(RetainedTopics& topics, const std::string& refuses) {
  std::string told;
  topics.begin();
  while (const auto* message = topics.next()) {
    const std::string topic = message->first;
    if (topic == refuses) {
      topics.refused(topic);
      return told;
    }
    told += topic;
    topics.told(topic);
  }
  return told;
}

RetainedTopics three() {
  RetainedTopics topics;
  for (const char* topic : {"a", "b", "c"}) topics.take(topic, "1");
  return topics;
}

TEST(RetainedTopics, AMessageThatIsNotTakenKeepsNoOthersAndIsLeftOut) {
  RetainedTopics topics = three();
  EXPECT_EQ(told_until_it_drops(topics, "b"), "a");
  for (int i = 0; i < RetainedTopics::kMostRefusals; ++i) {
    EXPECT_FALSE(topics.leaves_out());
    EXPECT_EQ(told_until_it_drops(topics, "b"), "ac") << "it comes last now";
  }
  EXPECT_TRUE(topics.leaves_out());
  EXPECT_EQ(told_until_it_drops(topics, "b"), "ac");
  EXPECT_EQ(topics.next(), nullptr) << "it is not tried";
  topics.take("b", "2");
  EXPECT_EQ(topics.next()->second.body, "2") << "a newer one is";
  EXPECT_TRUE(topics.refused("b")) << "once";
  topics.take("b", "3");
  topics.told("b");
  EXPECT_FALSE(topics.leaves_out());
}

TEST(RetainedTopics, WhereNothingIsTakenNoMessageIsToBlame) {
  RetainedTopics topics = three();
  for (int i = 0; i < 20; ++i) {
    topics.begin();
    EXPECT_FALSE(topics.refused(topics.next()->first));
  }
  EXPECT_FALSE(topics.leaves_out());
  EXPECT_EQ(told_until_it_drops(topics, ""), "abc");
}

}  // namespace
}  // namespace packmerger
