#include "daemon/local/socket_server.h"

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "base/descriptor.h"
#include "base/error.h"
#include "base/time/soon.h"

namespace packmerger {
namespace {

[[noreturn]] void cannot_listen(const std::filesystem::path& path, const std::string& why) {
  throw Error(Fault::kCannotWrite, "Cannot listen at " + path.string() + ": " + why,
              "Name another socket in the daemon's settings, or make its folder writable.");
}

sockaddr_un address_of(const std::filesystem::path& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.string().size() >= sizeof address.sun_path)
    cannot_listen(path, "the path is longer than 107 bytes");
  std::strcpy(address.sun_path, path.c_str());
  return address;
}

int make_socket() { return ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0); }

// A socket nobody answers at is what a daemon that died left behind.
void remove_stale(const std::filesystem::path& path) {
  struct stat status {};
  if (::lstat(path.c_str(), &status) != 0) return;
  if (!S_ISSOCK(status.st_mode)) cannot_listen(path, "something else is there");
  const bool silent = soon([address = address_of(path)] {
    const Descriptor probe(make_socket());
    return ::connect(probe.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) !=
               0 &&
           errno != EAGAIN;
  });
  if (!silent)
    throw Error(Fault::kBusy, "Another program answers at " + path.string(),
                "End it, or name another socket in the daemon's settings.");
  ::unlink(path.c_str());
}

}  // namespace

SocketServer::SocketServer(std::filesystem::path path, unsigned mode, Answer answer,
                           SocketLimits limits)
    : path_(std::move(path)), answer_(std::move(answer)), limits_(limits) {
  remove_stale(path_);
  const sockaddr_un address = address_of(path_);
  listener_ = make_socket();
  // nobody can connect before listen(), so that the mode holds from the start
  const bool listening =
      listener_ >= 0 &&
      ::bind(listener_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 &&
      ::chmod(path_.c_str(), mode) == 0 && ::listen(listener_, 64) == 0;
  if (listening) return;
  const std::string why = std::strerror(errno);
  if (listener_ >= 0) ::close(listener_);
  cannot_listen(path_, why);
}

SocketServer::~SocketServer() {
  for (const Client& client : clients_) ::close(client.fd);
  ::close(listener_);
  ::unlink(path_.c_str());
}

void SocketServer::add_to(std::vector<pollfd>& waiting) const {
  if (clients_.size() < limits_.clients) waiting.push_back({listener_, POLLIN, 0});
  for (const Client& client : clients_)
    waiting.push_back({client.fd, static_cast<short>(client.out.empty() ? POLLIN : POLLOUT), 0});
}

void SocketServer::serve(double now_s) {
  accept_clients(now_s);
  for (auto client = clients_.begin(); client != clients_.end();) {
    const bool open = write_to(*client, now_s) && read_from(*client, now_s) &&
                      write_to(*client, now_s) && now_s - client->active_s < limits_.idle_s &&
                      !(client->closing && client->out.empty());
    if (open) {
      ++client;
    } else {
      ::close(client->fd);
      client = clients_.erase(client);
    }
  }
}

void SocketServer::accept_clients(double now_s) {
  while (clients_.size() < limits_.clients) {
    const int fd = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
    if (fd < 0) return;
    Client client;
    client.fd = fd;
    client.active_s = now_s;
    clients_.push_back(std::move(client));
  }
}

// Nothing is read while a reply waits, so that a client cannot make replies pile up.
bool SocketServer::read_from(Client& client, double now_s) {
  while (client.out.empty() && !client.closing) {
    std::array<char, 4096> block;
    const ssize_t count = ::read(client.fd, block.data(), block.size());
    if (count < 0) return errno == EAGAIN || errno == EINTR;
    if (count == 0) return false;
    client.in.append(block.data(), static_cast<std::size_t>(count));
    answer_lines(client, now_s);
  }
  return true;
}

void SocketServer::answer_lines(Client& client, double now_s) {
  const std::size_t end = client.in.find('\n');
  if (end != std::string::npos) {
    client.out = answer_(std::string_view(client.in).substr(0, end)) + "\n";
    client.in.erase(0, end + 1);
    client.active_s = now_s;
  } else if (client.in.size() > limits_.request_bytes) {
    client.in.clear();
    client.out =
        R"({"error":{"fault":2,"hint":"Send one request a line.","what":"The request is too long"},"ok":false})"
        "\n";
    client.closing = true;
  }
}

bool SocketServer::write_to(Client& client, double now_s) {
  while (!client.out.empty()) {
    const ssize_t count = ::send(client.fd, client.out.data() + client.sent,
                                 client.out.size() - client.sent, MSG_NOSIGNAL);
    if (count < 0) return errno == EAGAIN || errno == EINTR;
    client.sent += static_cast<std::size_t>(count);
    client.active_s = now_s;
    if (client.sent < client.out.size()) continue;
    client.out = std::string();  // gives back the memory of a long reply
    client.sent = 0;
    answer_lines(client, now_s);  // a request that came together with the last one
  }
  return true;
}

}  // namespace packmerger
