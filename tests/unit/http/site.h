// A web server under test, and a client that knows nothing of HTTP.
#pragma once

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>

#include <array>
#include <chrono>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "base/descriptor.h"
#include "base/files.h"
#include "http/server.h"

namespace packmerger {

// Sends bytes and reads until the other side ends.
class Client {
 public:
  explicit Client(int port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<std::uint16_t>(port));
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(socket_.get(), reinterpret_cast<sockaddr*>(&to), sizeof to), 0);
    timeval patience{20, 0};
    ::setsockopt(socket_.get(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  }

  // False once the server does not want more.
  bool send(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t count = ::send(socket_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (count <= 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(count));
    }
    return true;
  }

  std::string read_until(const std::string& mark) {
    std::array<char, 4096> bytes;
    while (read_.find(mark) == std::string::npos) {
      const ssize_t count = ::recv(socket_.get(), bytes.data(), bytes.size(), 0);
      if (count <= 0) break;
      read_.append(bytes.data(), static_cast<std::size_t>(count));
    }
    return read_;
  }

  std::string rest() { return read_until(std::string("\0never", 6)); }

 private:
  Descriptor socket_;
  std::string read_;
};

struct Site {
  TemporaryFolder folder;
  std::vector<HttpRequest> seen;  // by answer
  std::vector<std::string> contents;
  std::uint64_t most_bytes = 1 << 20;
  std::optional<HttpServer> server;

  explicit Site(HttpLimits limits = {}) {
    limits.spare_bytes = 0;
    server.emplace("127.0.0.1", 0,
                   HttpHandler{[this](const HttpRequest& request) { return plan(request); },
                               [this](HttpRequest& request) { return answer(request); }},
                   limits);
  }

  BodyPlan plan(const HttpRequest& request) const {
    if (request.path == "/refused") return HttpReply{.status = 401, .body = "no key"};
    if (request.path == "/form") return TakeUpload{folder.path(), most_bytes, true};
    if (request.path == "/put") return TakeUpload{folder.path(), most_bytes, false};
    return TakeText{100};
  }

  HttpReply answer(HttpRequest& request) {
    for (const UploadedFile& file : request.files)
      contents.push_back(read_file(file.path, 1 << 24));
    seen.push_back(request);
    if (request.path == "/slow") {
      std::this_thread::sleep_for(std::chrono::milliseconds(2500));
      return {.body = "at last"};
    }
    if (request.path == "/file") return {.type = "text/plain", .file = folder.path() / "there"};
    if (request.path == "/kept" || request.path == "/immutable")
      return {.type = "text/plain",
              .file = folder.path() / "there",
              .keep = request.path == "/kept" ? Keep::kWhileTheSame : Keep::kForEver};
    if (request.path == "/link") return {.type = "text/plain", .file = folder.path() / "link"};
    return {.body = "{}", .headers = {{"X-Own", "yes"}}};
  }

  std::string ask(const std::string& request) {
    Client client(server->port());
    client.send(request);
    return client.rest();
  }
};

inline std::string get(const std::string& target) {
  return "GET " + target + " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n";
}

}  // namespace packmerger
