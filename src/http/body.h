// The body of an answer as libmicrohttpd takes it. For exchange.cpp only.
#pragma once

#include <microhttpd.h>

#include "http/message.h"

namespace packmerger {

struct ResponseBody {
  MHD_Response* response =
      nullptr;  // null: there is no such file; otherwise the caller destroys it
  unsigned status = 0;
};

// Small texts, scripts and scenes are compressed where the client takes that.
ResponseBody body_of(const HttpRequest& request, const HttpReply& reply);

}  // namespace packmerger
