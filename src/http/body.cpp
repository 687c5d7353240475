#include "http/body.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "base/descriptor.h"
#include "http/compress.h"

namespace packmerger {
namespace {

constexpr std::size_t kStreamBlock = 16384;
// More than that is sent as it is: it is compressed in memory.
constexpr std::uint64_t kMostCompressed = std::uint64_t{2} << 20;
constexpr std::uint64_t kLeastCompressed = 1024;

// The content of a streamed reply.
struct Stream {
  std::function<std::optional<std::string>()> next;
  std::string pending;
};

ssize_t read_stream(void* closure, std::uint64_t, char* to, std::size_t most) {
  auto* stream = static_cast<Stream*>(closure);
  if (stream->pending.empty()) {
    std::optional<std::string> more = stream->next();
    if (!more) return MHD_CONTENT_READER_END_OF_STREAM;
    stream->pending = std::move(*more);
  }
  const std::size_t count = std::min(most, stream->pending.size());
  std::memcpy(to, stream->pending.data(), count);
  stream->pending.erase(0, count);
  return static_cast<ssize_t>(count);
}

// Pictures, fonts and 3MF are compressed in themselves.
bool shrinks(std::string_view type) {
  constexpr std::array<std::string_view, 5> kTypes = {"text/", "application/json", "image/svg",
                                                      "model/gltf", "application/toml"};
  return type != "text/event-stream" &&
         std::any_of(kTypes.begin(), kTypes.end(),
                     [&](std::string_view kind) { return type.starts_with(kind); });
}

bool may_compress(const HttpRequest& request, const HttpReply& reply, std::uint64_t bytes) {
  return bytes >= kLeastCompressed && bytes <= kMostCompressed && shrinks(reply.type) &&
         takes_gzip(request);
}

MHD_Response* text_response(const std::string& text) {
  return MHD_create_response_from_buffer(text.size(), const_cast<char*>(text.data()),
                                         MHD_RESPMEM_MUST_COPY);
}

MHD_Response* compressed(const std::string& text) {
  MHD_Response* response = text_response(gzipped(text));
  if (response != nullptr)
    MHD_add_response_header(response, MHD_HTTP_HEADER_CONTENT_ENCODING, "gzip");
  return response;
}

// Changes whenever the file does: files of a job and of the page are replaced, never written over.
std::string tag_of(const struct stat& file, bool is_compressed) {
  const auto changed_ns = static_cast<std::uint64_t>(file.st_mtim.tv_sec) * 1'000'000'000u +
                          static_cast<std::uint64_t>(file.st_mtim.tv_nsec);
  return "\"" + std::to_string(file.st_ino) + "-" + std::to_string(file.st_size) + "-" +
         std::to_string(changed_ns) + (is_compressed ? "-z\"" : "\"");
}

// If-None-Match is a list of such tags.
bool has_already(const HttpRequest& request, const std::string& tag) {
  return request.header("If-None-Match").find(tag) != std::string_view::npos;
}

// Shorter where the file was cut meanwhile.
std::string contents(int file, std::uint64_t bytes) {
  std::string text(bytes, '\0');
  std::size_t have = 0;
  while (have < text.size()) {
    const ssize_t count = ::read(file, text.data() + have, text.size() - have);
    if (count <= 0) break;
    have += static_cast<std::size_t>(count);
  }
  text.resize(have);
  return text;
}

ResponseBody file_body(const HttpRequest& request, const HttpReply& reply) {
  Descriptor file(::open(reply.file.c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK));
  struct stat known;
  if (file.get() < 0 || ::fstat(file.get(), &known) != 0 || !S_ISREG(known.st_mode)) return {};
  const auto bytes = static_cast<std::uint64_t>(known.st_size);
  const bool compresses = may_compress(request, reply, bytes);
  const std::string tag = tag_of(known, compresses);
  ResponseBody body{nullptr, static_cast<unsigned>(reply.status)};
  if (reply.keep == Keep::kWhileTheSame && has_already(request, tag)) {
    body = {text_response(""), MHD_HTTP_NOT_MODIFIED};
  } else if (compresses) {
    body.response = compressed(contents(file.get(), bytes));
  } else {
    body.response = MHD_create_response_from_fd64(bytes, file.get());
    if (body.response != nullptr) file.release();
  }
  if (body.response == nullptr) return {};
  if (reply.keep != Keep::kNothing)
    MHD_add_response_header(
        body.response, MHD_HTTP_HEADER_CACHE_CONTROL,
        reply.keep == Keep::kForEver ? "public, max-age=31536000, immutable" : "private, no-cache");
  if (reply.keep == Keep::kWhileTheSame)
    MHD_add_response_header(body.response, MHD_HTTP_HEADER_ETAG, tag.c_str());
  return body;
}

ResponseBody text_body(const HttpRequest& request, const HttpReply& reply) {
  const bool compresses = may_compress(request, reply, reply.body.size());
  return {compresses ? compressed(reply.body) : text_response(reply.body),
          static_cast<unsigned>(reply.status)};
}

ResponseBody stream_body(const HttpReply& reply) {
  auto* stream = new Stream{reply.next, {}};
  return {MHD_create_response_from_callback(
              MHD_SIZE_UNKNOWN, kStreamBlock, read_stream, stream,
              [](void* closure) { delete static_cast<Stream*>(closure); }),
          static_cast<unsigned>(reply.status)};
}

}  // namespace

ResponseBody body_of(const HttpRequest& request, const HttpReply& reply) {
  ResponseBody body;
  if (!reply.file.empty())
    body = file_body(request, reply);
  else
    body = reply.next ? stream_body(reply) : text_body(request, reply);
  if (body.response == nullptr) return body;
  if (shrinks(reply.type))
    MHD_add_response_header(body.response, MHD_HTTP_HEADER_VARY, MHD_HTTP_HEADER_ACCEPT_ENCODING);
  if (reply.keep == Keep::kNothing)
    MHD_add_response_header(body.response, MHD_HTTP_HEADER_CACHE_CONTROL, "no-store");
  return body;
}

}  // namespace packmerger
