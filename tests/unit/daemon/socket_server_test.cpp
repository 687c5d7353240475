#include "daemon/local/socket_server.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>
#include <fstream>

#include "base/error.h"
#include "base/files.h"

namespace packmerger {
namespace {

// The server runs on the test's own thread and clock.
class SocketServerTest : public testing::Test {
 protected:
  SocketServerTest() { start({}); }

  void start(SocketLimits limits) {
    server_.reset();
    server_ = std::make_unique<SocketServer>(
        path(), 0600, [this](std::string_view request) { return reply(request); }, limits);
  }

  std::string reply(std::string_view request) {
    ++answered_;
    return request == "big" ? std::string(4 << 20, 'x') : "got " + std::string(request);
  }

  fs::path path() const { return folder_.path() / "s"; }

  int connect() {
    const int fd = ::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strcpy(address.sun_path, path().c_str());
    EXPECT_EQ(::connect(fd, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    return fd;
  }

  // Sends what fits, serving in between; false once the server has gone away.
  bool send_all(int fd, std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t count = ::send(fd, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (count < 0 && errno != EAGAIN) return false;
      if (count > 0) bytes.remove_prefix(static_cast<std::size_t>(count));
      server_->serve(now_s_);
    }
    return true;
  }

  // Everything that comes within some rounds; sets closed_ at the end of the stream.
  std::string receive(int fd, int rounds = 50) {
    std::string text;
    std::vector<char> block(1 << 16);
    while (rounds-- > 0 && !closed_) {
      server_->serve(now_s_);
      const ssize_t count = ::read(fd, block.data(), block.size());
      closed_ = count == 0 || (count < 0 && errno == ECONNRESET);
      if (count > 0) text.append(block.data(), static_cast<std::size_t>(count));
    }
    return text;
  }

  TemporaryFolder folder_;
  std::unique_ptr<SocketServer> server_;
  double now_s_ = 0;
  int answered_ = 0;
  bool closed_ = false;
};

TEST_F(SocketServerTest, OneLineInOneLineOut) {
  const int fd = connect();
  EXPECT_TRUE(send_all(fd, "one\ntwo\nthr"));
  EXPECT_EQ(receive(fd), "got one\ngot two\n");
  EXPECT_TRUE(send_all(fd, "ee\n"));
  EXPECT_EQ(receive(fd), "got three\n");
  ::close(fd);
}

TEST_F(SocketServerTest, OnlyItsOwnerMayConnect) {
  struct stat status {};
  ASSERT_EQ(::stat(path().c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0600U);
}

TEST_F(SocketServerTest, AnEndlessLineIsCutOff) {
  const int fd = connect();
  std::string text;
  bool open = true;
  for (int i = 0; i < 100 && open; ++i) {
    open = send_all(fd, std::string(10000, 'x'));
    text += receive(fd, 2);
    open = open && !closed_;
  }
  EXPECT_FALSE(open);
  EXPECT_EQ(answered_, 0);
  EXPECT_NE(text.find("too long"), std::string::npos);
  ::close(fd);
}

TEST_F(SocketServerTest, NobodyMakesRepliesPileUp) {
  const int fd = connect();
  std::string requests;
  for (int i = 0; i < 1000; ++i) requests += "big\n";
  ::send(fd, requests.data(), requests.size(), MSG_NOSIGNAL);
  for (int i = 0; i < 100; ++i) server_->serve(now_s_);
  EXPECT_EQ(answered_, 1) << "the first reply is not read yet";
  now_s_ += 31;
  server_->serve(now_s_);
  receive(fd, 1000);
  EXPECT_TRUE(closed_);
  ::close(fd);
}

TEST_F(SocketServerTest, ASilentClientIsSentAwayAndOthersWaitForItsPlace) {
  SocketLimits limits;
  limits.clients = 2;
  start(limits);
  const int first = connect();
  const int second = connect();
  server_->serve(now_s_);
  const int third = connect();
  EXPECT_TRUE(send_all(third, "x\n"));
  EXPECT_EQ(receive(third), "");
  now_s_ += 31;
  EXPECT_EQ(receive(third), "got x\n");
  for (const int fd : {first, second, third}) ::close(fd);
}

TEST_F(SocketServerTest, ReplacesAStaleSocketButNothingElse) {
  EXPECT_THROW(SocketServer(path(), 0600, [](std::string_view) { return ""; }), Error);
  server_.reset();
  EXPECT_FALSE(fs::exists(path()));
  {
    const int fd = ::socket(AF_UNIX, SOCK_STREAM, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strcpy(address.sun_path, path().c_str());
    ASSERT_EQ(::bind(fd, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    ::close(fd);
  }
  start({});
  server_.reset();
  std::ofstream(path()) << "precious";
  EXPECT_THROW(start({}), Error);
  EXPECT_EQ(read_file(path(), 100), "precious");
}

}  // namespace
}  // namespace packmerger
