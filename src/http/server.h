// An HTTP/1.1 server (RFC 9112; libmicrohttpd) with a thread for each connection. Memory for
// each connection is bounded whatever a client sends; uploads go to the disk as they come.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "http/message.h"
#include "http/patience.h"

namespace packmerger {

struct HttpHandler {
  // Called on the connection's thread once the headers are there. A reply at once refuses the
  // request before its body is read (and before a client that expects 100-continue sends it).
  std::function<BodyPlan(const HttpRequest&)> plan;
  // Called when the body is there. The files of an upload are removed when it has returned, unless
  // they were moved away.
  std::function<HttpReply(HttpRequest&)> answer;
};

struct HttpLimits {
  unsigned connections = 192;
  unsigned connections_of_a_peer = 96;
  unsigned idle_s = 30;              // a connection on which nothing happens ends
  PatienceLimits patience = {};      // and so does one on which too little happens
  std::size_t memory_bytes = 32768;  // of a connection: request line and headers
  std::size_t field_bytes = 4096;    // of a form's field that is no file
  std::size_t fields = 16;           // of a form, files included
  std::uint64_t spare_bytes = std::uint64_t{256} << 20;  // left free on the disk by uploads
};

class HttpServer {
 public:
  // Listens at a numeric address ("127.0.0.1", "::1", "0.0.0.0"); port 0 takes a free one. Throws
  // Error{kBusy} where the port is taken, Error{kCannotWrite} where listening is not allowed,
  // Error{kBadProfile} for an address that is none.
  HttpServer(const std::string& address, int port, HttpHandler handler, HttpLimits limits = {});
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;
  ~HttpServer();  // waits for the connections' threads; what `next` waits for must have ended

  int port() const;

 private:
  struct Daemon;
  std::unique_ptr<Daemon> daemon_;
};

}  // namespace packmerger
