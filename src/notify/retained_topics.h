// The newest message of every topic, and which of them a broker has. A message that it does not
// take keeps none of the others from it.
#pragma once

#include <map>
#include <string>

namespace packmerger {

class RetainedTopics {
 public:
  static constexpr int kMostRefusals = 3;

  // A newer message of a topic.
  void take(const std::string& topic, std::string body);

  // A broker that may know none of them. What is left out stays so until there is a newer one.
  void begin();

  // What it is to be told next; nothing: it has all. What it did not take comes last.
  struct Message {
    std::string body;
    bool is_told = false;
    bool is_doubtful = false;  // it was not taken, whoever is to blame
    int refusals = 0;          // though all that is not doubtful was
    bool is_left_out = false;
  };
  const std::pair<const std::string, Message>* next() const;

  void told(const std::string& topic);
  // It did not take it. True: it took all others, now for the third time, so this one is left out.
  bool refused(const std::string& topic);

  bool leaves_out() const;  // any

 private:
  std::map<std::string, Message> topics_;
};

}  // namespace packmerger
