// One request on its way in and its answer on the way out, as libmicrohttpd calls for them. For
// server.cpp only.
#pragma once

#include <microhttpd.h>

#include <optional>
#include <string>
#include <string_view>

#include "http/part_names.h"
#include "http/server.h"
#include "http/upload.h"

namespace packmerger {

// The client's numeric address; empty where it is not known.
std::string peer_of(MHD_Connection* connection);

class Exchange {
 public:
  // target: as it stands in the request line. handler and limits must outlive it.
  Exchange(std::string target, const HttpHandler& handler, const HttpLimits& limits)
      : target_(std::move(target)), handler_(handler), limits_(limits) {}
  Exchange(const Exchange&) = delete;
  Exchange& operator=(const Exchange&) = delete;
  ~Exchange();

  // Called with the headers, then with each piece of the body, then with none: an access handler.
  MHD_Result step(MHD_Connection* connection, const char* method, const char* data,
                  std::size_t* size);

  bool begun() const { return begun_; }  // the headers were looked at

 private:
  MHD_Result begin(MHD_Connection* connection, const char* method);
  MHD_Result begin_upload(MHD_Connection* connection, const TakeUpload& plan);
  MHD_Result finish(MHD_Connection* connection);
  std::uint64_t announced() const;
  int take(std::string_view bytes);
  int add_to_form(const std::string& key, const char* file, std::string_view bytes,
                  std::uint64_t offset);
  static MHD_Result take_field(void* closure, MHD_ValueKind, const char* key, const char* file,
                               const char*, const char*, const char* data, std::uint64_t offset,
                               std::size_t size);

  std::string target_;
  const HttpHandler& handler_;
  const HttpLimits& limits_;
  HttpRequest request_;
  bool begun_ = false;
  int status_ = 0;  // of the answer, once the body cannot be taken
  std::size_t most_text_ = 0;
  std::optional<Upload> upload_;
  MHD_PostProcessor* form_ = nullptr;
  std::optional<PartNames> names_;  // with form_
};

}  // namespace packmerger
