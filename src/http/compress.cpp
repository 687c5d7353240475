#include "http/compress.h"

#include <zlib.h>

#include <cctype>

#include "base/error.h"

namespace packmerger {
namespace {

constexpr int kGzip = 16 + MAX_WBITS;
constexpr int kLevel = 6;
constexpr int kMemory = 8;

std::string without_blanks(std::string_view text) {
  std::string out;
  for (const char c : text)
    if (c != ' ' && c != '\t')
      out += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

bool refuses(std::string_view parameter) {
  return parameter.starts_with("q=0") &&
         parameter.find_first_of("123456789") == std::string_view::npos;
}

}  // namespace

bool takes_gzip(const HttpRequest& request) {
  std::string rest = without_blanks(request.header("Accept-Encoding"));
  while (!rest.empty()) {
    const std::string item = rest.substr(0, rest.find(','));
    rest.erase(0, item.size() + 1);
    const std::size_t end = item.find(';');
    if (item.substr(0, end) == "gzip")
      return end == std::string::npos || !refuses(std::string_view(item).substr(end + 1));
  }
  return false;
}

std::string gzipped(std::string_view bytes) {
  z_stream stream{};
  std::string out;
  bool done = deflateInit2(&stream, kLevel, Z_DEFLATED, kGzip, kMemory, Z_DEFAULT_STRATEGY) == Z_OK;
  if (done) {
    out.resize(deflateBound(&stream, bytes.size()));
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream.avail_in = static_cast<uInt>(bytes.size());
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = static_cast<uInt>(out.size());
    done = deflate(&stream, Z_FINISH) == Z_STREAM_END;
    out.resize(stream.total_out);
    deflateEnd(&stream);
  }
  if (!done) throw Error(Fault::kInternal, "An answer could not be compressed", "Try again.");
  return out;
}

}  // namespace packmerger
