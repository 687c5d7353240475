#include "daemon/local/loop_proxy.h"

#include <gtest/gtest.h>

#include <thread>

namespace packmerger {
namespace {

TEST(LoopProxy, WhatWasAnsweredAsBusyIsNeverDone) {
  WebQuestions questions;
  const LoopProxy desk(questions, std::chrono::milliseconds(10));
  EXPECT_EQ(desk.take({.printer = "m", .name = "a.stl", .file = "/x"}).status, 503);
  const std::shared_ptr<WebQuestion> late = questions.try_pop().value();
  EXPECT_FALSE(late->begin()) << "it was taken back";
}

TEST(LoopProxy, WhatWasBegunIsAnsweredTrulyHoweverLongItTakes) {
  WebQuestions questions;
  const LoopProxy desk(questions, std::chrono::milliseconds(300));
  std::thread loop([&] {
    const std::shared_ptr<WebQuestion> question = questions.pop().value();
    ASSERT_TRUE(question->begin());
    std::this_thread::sleep_for(std::chrono::milliseconds(600));
    question->answer.set_value(R"({"ok":true,"result":{"id":7}})");
  });
  const HttpReply reply = desk.take({.printer = "m", .name = "a.stl", .file = "/x"});
  loop.join();
  EXPECT_EQ(reply.status, 201);
  EXPECT_EQ(reply.body, "{\"id\":7}\n");
}

}  // namespace
}  // namespace packmerger
