#include "http/server.h"

#include <microhttpd.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>

#include "base/descriptor.h"
#include "base/error.h"
#include "base/time/soon.h"
#include "http/exchange.h"

namespace packmerger {
namespace {

Descriptor listening_socket(const std::string& address, int port) {
  addrinfo wanted{};
  wanted.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV | AI_PASSIVE;
  wanted.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (::getaddrinfo(address.c_str(), std::to_string(port).c_str(), &wanted, &found) != 0)
    throw Error(Fault::kBadProfile, address + " is no numeric address",
                "Give one such as 127.0.0.1 or ::1.");
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> held(found, ::freeaddrinfo);
  Descriptor socket(::socket(found->ai_family, SOCK_STREAM | SOCK_CLOEXEC, 0));
  const int on = 1;
  ::setsockopt(socket.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  int error = 0;
  soon([&] {
    const bool bound = ::bind(socket.get(), found->ai_addr, found->ai_addrlen) == 0;
    error = bound ? 0 : errno;
    return error != EADDRINUSE;
  });
  if (error == 0 && ::listen(socket.get(), SOMAXCONN) == 0) return socket;
  if (error == 0) error = errno;
  const std::string what =
      "Cannot listen at " + address + " port " + std::to_string(port) + ": " + std::strerror(error);
  if (error == EADDRINUSE)
    throw Error(Fault::kBusy, what, "End the program that listens there, or choose another port.");
  throw Error(Fault::kCannotWrite, what,
              "Choose an address of this machine and a port above 1023.");
}

}  // namespace

struct HttpServer::Daemon {
  explicit Daemon(HttpHandler asked, HttpLimits limited)
      : handler(std::move(asked)), limits(limited), patience(limited.patience) {}

  HttpHandler handler;
  HttpLimits limits;
  Patience patience;
  MHD_Daemon* running = nullptr;
  int port = 0;

  static void* begun(void* closure, const char* target, MHD_Connection*) {
    const auto* self = static_cast<Daemon*>(closure);
    return new Exchange(target, self->handler, self->limits);
  }
  static MHD_Result step(void* closure, MHD_Connection* connection, const char*, const char* method,
                         const char*, const char* data, std::size_t* size, void** exchange) {
    static_cast<Daemon*>(closure)->note(connection, *static_cast<Exchange*>(*exchange), *size);
    try {
      return static_cast<Exchange*>(*exchange)->step(connection, method, data, size);
    } catch (const std::exception&) {
      return MHD_NO;  // out of memory: the connection ends
    }
  }
  static void ended(void* closure, MHD_Connection* connection, void** exchange,
                    MHD_RequestTerminationCode) {
    delete static_cast<Exchange*>(*exchange);
    *exchange = nullptr;
    if (HttpSender* sender = sender_of(connection))
      static_cast<Daemon*>(closure)->patience.awaits(sender, HttpSender::Awaits::kHeaders);
  }
  // Told of every connection, before its socket is closed too.
  static void on_connection(void* closure, MHD_Connection* connection, void** sender,
                            MHD_ConnectionNotificationCode code) {
    Patience& patience = static_cast<Daemon*>(closure)->patience;
    if (code == MHD_CONNECTION_NOTIFY_STARTED) {
      const MHD_ConnectionInfo* info =
          MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CONNECTION_FD);
      *sender = patience.begun(info->connect_fd, peer_of(connection));
    } else {
      patience.ended(static_cast<HttpSender*>(*sender));
      *sender = nullptr;
    }
  }
  static HttpSender* sender_of(MHD_Connection* connection) {
    const MHD_ConnectionInfo* info =
        MHD_get_connection_info(connection, MHD_CONNECTION_INFO_SOCKET_CONTEXT);
    return info == nullptr ? nullptr : static_cast<HttpSender*>(info->socket_context);
  }
  // What came of a request, before it is looked at: its headers, a piece of its body, or its end.
  void note(MHD_Connection* connection, const Exchange& exchange, std::size_t bytes) {
    HttpSender* sender = sender_of(connection);
    if (sender == nullptr) return;
    if (!exchange.begun())
      patience.awaits(sender, HttpSender::Awaits::kBody);
    else if (bytes > 0)
      patience.received(sender, bytes);
    else
      patience.awaits(sender, HttpSender::Awaits::kNothing);
  }
  // Targets are decoded by decoded_path and decoded_query.
  static std::size_t as_it_is(void*, MHD_Connection*, char* text) { return std::strlen(text); }
};

HttpServer::HttpServer(const std::string& address, int port, HttpHandler handler, HttpLimits limits)
    : daemon_(std::make_unique<Daemon>(std::move(handler), limits)) {
  Descriptor socket = listening_socket(address, port);
  sockaddr_in6 bound{};  // large enough for both families, which have the port at the same place
  socklen_t size = sizeof bound;
  ::getsockname(socket.get(), reinterpret_cast<sockaddr*>(&bound), &size);
  daemon_->port = ntohs(bound.sin6_port);
  const unsigned flags =
      MHD_USE_THREAD_PER_CONNECTION | MHD_USE_INTERNAL_POLLING_THREAD | MHD_USE_POLL | MHD_USE_ITC;
  daemon_->running = MHD_start_daemon(
      flags, 0, nullptr, nullptr, Daemon::step, daemon_.get(), MHD_OPTION_LISTEN_SOCKET,
      socket.get(), MHD_OPTION_URI_LOG_CALLBACK, Daemon::begun, daemon_.get(),
      MHD_OPTION_NOTIFY_COMPLETED, Daemon::ended, daemon_.get(), MHD_OPTION_NOTIFY_CONNECTION,
      Daemon::on_connection, daemon_.get(), MHD_OPTION_UNESCAPE_CALLBACK, Daemon::as_it_is, nullptr,
      MHD_OPTION_CONNECTION_MEMORY_LIMIT, limits.memory_bytes, MHD_OPTION_CONNECTION_LIMIT,
      limits.connections, MHD_OPTION_PER_IP_CONNECTION_LIMIT, limits.connections_of_a_peer,
      MHD_OPTION_CONNECTION_TIMEOUT, limits.idle_s, MHD_OPTION_STRICT_FOR_CLIENT, 1,
      MHD_OPTION_END);
  if (daemon_->running == nullptr)
    throw Error(Fault::kCannotWrite, "The web server cannot be started",
                "Raise the limit on open files (ulimit -n) and start again.");
  socket.release();
}

HttpServer::~HttpServer() { MHD_stop_daemon(daemon_->running); }

int HttpServer::port() const { return daemon_->port; }

}  // namespace packmerger
