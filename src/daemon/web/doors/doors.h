// Which door a request takes.
#pragma once

#include <string>
#include <vector>

#include "daemon/local/loop_proxy.h"
#include "http/message.h"

namespace packmerger {

// Whether a path is one of /printers/…, where every request needs a key.
bool leads_to_door(const std::string& path);

// What is done with the body of a request that has passed the guard: 404 where there is no such
// route or printer, 415 where its name already tells that it is not taken. `room`: where files go.
BodyPlan plan_at_door(const HttpRequest& request, const LoopProxy& loop, const TakeUpload& room);

HttpReply answer_at_door(const HttpRequest& request, const LoopProxy& loop);

}  // namespace packmerger
