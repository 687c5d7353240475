#include "http/exchange.h"

#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>

#include "http/body.h"
#include "http/path.h"

namespace packmerger {
namespace {

constexpr std::size_t kFormBuffer = 32768;
constexpr std::size_t kMostHeaders = 64;

bool is_loopback(const sockaddr* address) {
  if (address == nullptr) return false;
  if (address->sa_family == AF_INET) {
    const auto* four = reinterpret_cast<const sockaddr_in*>(address);
    return (ntohl(four->sin_addr.s_addr) >> 24) == 127;
  }
  if (address->sa_family != AF_INET6) return false;
  const in6_addr& six = reinterpret_cast<const sockaddr_in6*>(address)->sin6_addr;
  return IN6_IS_ADDR_LOOPBACK(&six) || (IN6_IS_ADDR_V4MAPPED(&six) && six.s6_addr[12] == 127);
}

const sockaddr* address_of(MHD_Connection* connection) {
  const MHD_ConnectionInfo* info =
      MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CLIENT_ADDRESS);
  return info == nullptr ? nullptr : info->client_addr;
}

std::string numeric(const sockaddr* address) {
  if (address == nullptr) return {};
  const socklen_t size = address->sa_family == AF_INET ? sizeof(sockaddr_in) : sizeof(sockaddr_in6);
  std::array<char, NI_MAXHOST> text{};
  if (::getnameinfo(address, size, text.data(), text.size(), nullptr, 0, NI_NUMERICHOST) != 0)
    return {};
  return text.data();
}

HttpReply plain(int status, const std::string& sentence) {
  return {.status = status, .type = "text/plain", .body = sentence + "\n"};
}

HttpReply refusal(int status) {
  if (status == 413) return plain(status, "That is more than is taken at once.");
  if (status == 507) return plain(status, "The disk has too little room for that; free some.");
  if (status == 400) return plain(status, "The request cannot be understood.");
  return plain(status, "The upload could not be written; look into the daemon's messages.");
}

MHD_Result send(MHD_Connection* connection, const HttpRequest& request, const HttpReply& reply) {
  const ResponseBody body = body_of(request, reply);
  if (body.response == nullptr)
    return send(connection, request, plain(404, "There is no such file."));
  MHD_add_response_header(body.response, MHD_HTTP_HEADER_CONTENT_TYPE, reply.type.c_str());
  for (const auto& [name, value] : reply.headers)
    MHD_add_response_header(body.response, name.c_str(), value.c_str());
  const MHD_Result sent = MHD_queue_response(connection, body.status, body.response);
  MHD_destroy_response(body.response);
  return sent;
}

MHD_Result add_header(void* closure, MHD_ValueKind, const char* name, const char* value) {
  static_cast<std::vector<std::pair<std::string, std::string>>*>(closure)->emplace_back(
      name, value == nullptr ? "" : value);
  return MHD_YES;
}

}  // namespace

std::string peer_of(MHD_Connection* connection) { return numeric(address_of(connection)); }

Exchange::~Exchange() {
  if (form_ != nullptr) MHD_destroy_post_processor(form_);
}

MHD_Result Exchange::step(MHD_Connection* connection, const char* method, const char* data,
                          std::size_t* size) {
  if (!begun_) {
    begun_ = true;
    return begin(connection, method);
  }
  if (*size > 0) {
    if (status_ == 0) status_ = take({data, *size});
    *size = 0;
    return MHD_YES;
  }
  return finish(connection);
}

MHD_Result Exchange::begin(MHD_Connection* connection, const char* method) {
  request_.method = std::strcmp(method, "HEAD") == 0 ? "GET" : method;
  const std::size_t question = std::min(target_.find('?'), target_.size());
  const std::optional<std::string> path = decoded_path(target_.substr(0, question));
  if (!path) return send(connection, request_, refusal(400));
  request_.path = *path;
  if (question < target_.size()) request_.query = decoded_query(target_.substr(question + 1));
  request_.peer = peer_of(connection);
  request_.is_loopback = is_loopback(address_of(connection));
  MHD_get_connection_values(connection, MHD_HEADER_KIND, add_header, &request_.headers);
  if (request_.headers.size() > kMostHeaders) return send(connection, request_, refusal(400));
  BodyPlan plan = handler_.plan(request_);
  if (const auto* reply = std::get_if<HttpReply>(&plan)) return send(connection, request_, *reply);
  if (const auto* text = std::get_if<TakeText>(&plan)) most_text_ = text->most_bytes;
  if (const auto* upload = std::get_if<TakeUpload>(&plan)) return begin_upload(connection, *upload);
  return announced() > most_text_ ? send(connection, request_, refusal(413)) : MHD_YES;
}

MHD_Result Exchange::begin_upload(MHD_Connection* connection, const TakeUpload& plan) {
  if (announced() > plan.most_bytes) return send(connection, request_, refusal(413));
  if (!Upload::has_room(plan.folder, announced(), limits_.spare_bytes))
    return send(connection, request_, refusal(507));
  upload_.emplace(plan.folder, plan.most_bytes, limits_.spare_bytes);
  if (plan.is_form) {
    names_.emplace(request_.header("Content-Type"));
    form_ = MHD_create_post_processor(connection, kFormBuffer, take_field, this);
    return form_ == nullptr ? send(connection, request_, refusal(400)) : MHD_YES;
  }
  const int status = upload_->begin("", "");
  return status == 0 ? MHD_YES : send(connection, request_, refusal(status));
}

// The body's length as the client announced it; 0 where it did not.
std::uint64_t Exchange::announced() const {
  const std::string_view text = request_.header("Content-Length");
  std::uint64_t length = 0;
  std::from_chars(text.data(), text.data() + text.size(), length);
  return length;
}

int Exchange::take(std::string_view bytes) {
  if (form_ != nullptr) {
    const std::string form = names_->pass(bytes);
    const bool understood = MHD_post_process(form_, form.data(), form.size()) == MHD_YES;
    return understood || status_ != 0 ? status_ : 400;
  }
  if (upload_) return upload_->write(bytes);
  if (request_.body.size() + bytes.size() > most_text_) return 413;
  request_.body += bytes;
  return 0;
}

MHD_Result Exchange::take_field(void* closure, MHD_ValueKind, const char* key, const char* file,
                                const char*, const char*, const char* data, std::uint64_t offset,
                                std::size_t size) {
  auto* self = static_cast<Exchange*>(closure);
  self->status_ = self->add_to_form(key, file, {data, size}, offset);
  return self->status_ == 0 ? MHD_YES : MHD_NO;
}

int Exchange::add_to_form(const std::string& key, const char* file, std::string_view bytes,
                          std::uint64_t offset) {
  if (offset == 0 && request_.form.size() + upload_->files().size() >= limits_.fields) return 400;
  if (file == nullptr) {
    std::string& value = request_.form[key];
    if (value.size() + bytes.size() > limits_.field_bytes) return 413;
    value += bytes;
    return 0;
  }
  if (offset == 0)
    if (const int status = upload_->begin(key, name_of_part(file)); status != 0) return status;
  return upload_->write(bytes);
}

MHD_Result Exchange::finish(MHD_Connection* connection) {
  if (form_ != nullptr) {
    const bool whole = MHD_destroy_post_processor(form_) == MHD_YES;
    form_ = nullptr;
    if (status_ == 0 && !whole) status_ = 400;
  }
  if (upload_ && status_ == 0) status_ = upload_->end();
  if (status_ != 0) return send(connection, request_, refusal(status_));
  if (upload_) request_.files = upload_->files();
  return send(connection, request_, handler_.answer(request_));
}

}  // namespace packmerger
