// Clients that send a byte now and then are never silent, and would hold their connection for ever:
// this ends those that take too long, and the oldest of those that wait where there are too many.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <list>
#include <mutex>
#include <string>
#include <thread>

namespace packmerger {

struct PatienceLimits {
  double headers_s = 30;              // for a whole request line and headers, and between requests
  double body_s = 30;                 // a body may be slower than body_bytes_s for so long
  std::uint64_t body_bytes_s = 4096;  // on average, since the body began
  unsigned waiting = 96;              // connections that have sent no whole headers yet
  unsigned waiting_of_a_peer = 32;    // the same, of one address
};

// What a connection's client is to send now. Only Patience looks inside.
struct HttpSender {
  enum class Awaits { kHeaders, kBody, kNothing };
  int socket = -1;
  std::string peer;  // the client's address
  Awaits awaits = Awaits::kHeaders;
  double since_s = 0;
  std::uint64_t bytes = 0;
};

// Thread-safe. The time in which a client waits for its answer is not counted.
class Patience {
 public:
  explicit Patience(PatienceLimits limits);
  Patience(const Patience&) = delete;
  Patience& operator=(const Patience&) = delete;
  ~Patience();

  // A connection that has begun; ended() must be called for it before its socket is closed. Where
  // too many wait for their headers now, the longest waiting of the address that has most of them
  // is ended: whoever sends his request at once is never the one.
  HttpSender* begun(int socket, const std::string& peer);
  void ended(HttpSender* sender);

  // What it is to send from now on. kHeaders: a whole request line and headers.
  void awaits(HttpSender* sender, HttpSender::Awaits awaits);
  void received(HttpSender* sender, std::size_t bytes);  // of the body

 private:
  bool is_late(const HttpSender& sender, double now_s) const;
  void make_room();
  void watch();

  PatienceLimits limits_;
  std::mutex mutex_;  // guards the following and all senders
  std::condition_variable changed_;
  std::list<HttpSender> senders_;
  bool ending_ = false;
  std::thread watcher_;
};

}  // namespace packmerger
