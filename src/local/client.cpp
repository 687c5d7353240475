#include "local/client.h"

#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string>
#include <string_view>

#include "base/error.h"

namespace packmerger {
namespace {

using nlohmann::json;

constexpr time_t kTimeout_s = 10;
constexpr std::size_t kMaxReplyBytes = std::size_t{64} << 20;

constexpr const char* kStartIt =
    "Start it with packmergerd --config FILE, or name its socket with --socket; the package's "
    "service has it at /run/packmerger/packmergerd.sock.";

[[noreturn]] void not_there(const std::filesystem::path& socket, const std::string& why,
                            const char* hint = kStartIt) {
  throw Error(Fault::kUnavailable, "No daemon answers at " + socket.string() + ": " + why, hint);
}

[[noreturn]] void too_old(std::string verb) {
  std::replace(verb.begin(), verb.end(), '.', ' ');
  throw Error(Fault::kUsage,
              "The daemon that runs is older than this program, and does not know \"" + verb + "\"",
              "Restart it: systemctl restart packmergerd, where the package's service runs it; "
              "otherwise end it, and start the new one. That cancels what is being printed: wait "
              "until packmerger printers list shows no job.");
}

class Connection {
 public:
  explicit Connection(const std::filesystem::path& path)
      : path_(path), fd_(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    if (path.string().size() >= sizeof address.sun_path) fail("the path is too long");
    std::strcpy(address.sun_path, path.c_str());
    const timeval timeout{kTimeout_s, 0};
    ::setsockopt(fd_, SOL_SOCKET, SO_RCVTIMEO, &timeout, sizeof timeout);
    ::setsockopt(fd_, SOL_SOCKET, SO_SNDTIMEO, &timeout, sizeof timeout);
    if (::connect(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) return;
    if (errno == EACCES)
      fail("you may not speak to it",
           "Only the daemon's user and its group may (docs/INSTALL.md).");
    fail(std::strerror(errno));
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  ~Connection() { ::close(fd_); }

  void send(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t count = ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) not_there(path_, std::strerror(errno));
      bytes.remove_prefix(static_cast<std::size_t>(count));
    }
  }

  std::string receive_line() {
    std::string line;
    std::array<char, 65536> block;
    while (line.find('\n') == std::string::npos) {
      const ssize_t count = ::read(fd_, block.data(), block.size());
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) not_there(path_, errno == EAGAIN ? "it is silent" : std::strerror(errno));
      if (count == 0 || line.size() > kMaxReplyBytes) not_there(path_, "it ended the connection");
      line.append(block.data(), static_cast<std::size_t>(count));
    }
    return line;
  }

 private:
  [[noreturn]] void fail(const std::string& why, const char* hint = kStartIt) {
    ::close(fd_);
    not_there(path_, why, hint);
  }

  std::filesystem::path path_;
  int fd_;
};

}  // namespace

json ask_daemon(const std::filesystem::path& socket, const json& request) {
  Connection connection(socket);
  connection.send(request.dump(-1, ' ', false, json::error_handler_t::replace) + "\n");
  const json reply = json::parse(connection.receive_line(), nullptr, false);
  if (!reply.is_object()) not_there(socket, "it does not answer in PackMerger's way");
  if (reply.value("ok", false)) return reply.value("result", json());
  const json error = reply.value("error", json::object());
  if (error.value("what", "") == kUnknownVerb) too_old(request.value("verb", ""));
  throw Error(static_cast<Fault>(error.value("fault", static_cast<int>(Fault::kInternal))),
              error.value("what", "The daemon refused"),
              error.value("hint", "Look into the daemon's messages."));
}

}  // namespace packmerger
