// The daemon's local socket: one JSON request a line, one JSON reply a line. Only the loop's
// thread uses it, and it never waits: memory and time are bounded whatever a client does.
#pragma once

#include <poll.h>

#include <filesystem>
#include <functional>
#include <list>
#include <string>
#include <string_view>
#include <vector>

namespace packmerger {

struct SocketLimits {
  std::size_t clients = 32;           // further ones wait until one has gone
  std::size_t request_bytes = 65536;  // a longer line ends the connection
  double idle_s = 30;                 // without a whole request, or with a reply nobody reads
};

class SocketServer {
 public:
  using Answer = std::function<std::string(std::string_view request)>;

  // Binds and listens; a socket left by a daemon that died is replaced. mode: of the socket.
  // Throws Error{kBusy} when another program answers there, Error{kCannotWrite} otherwise.
  SocketServer(std::filesystem::path path, unsigned mode, Answer answer, SocketLimits limits = {});
  SocketServer(const SocketServer&) = delete;
  SocketServer& operator=(const SocketServer&) = delete;
  ~SocketServer();  // removes the socket

  // What to poll for before the next serve().
  void add_to(std::vector<pollfd>& waiting) const;

  // Accepts, reads, answers and writes what can be done at once.
  void serve(double now_s);

 private:
  struct Client {
    int fd = -1;
    std::string in;
    std::string out;
    std::size_t sent = 0;
    double active_s = 0;
    bool closing = false;  // once out is sent
  };

  void accept_clients(double now_s);
  bool read_from(Client& client, double now_s);
  void answer_lines(Client& client, double now_s);
  bool write_to(Client& client, double now_s);

  std::filesystem::path path_;
  Answer answer_;
  SocketLimits limits_;
  int listener_ = -1;
  std::list<Client> clients_;
};

}  // namespace packmerger
