// What a clerk does with files: taking them for jobs, copying and filing them. Each order is done
// on the calling thread, and answered with what the loop is to be told; nothing is thrown.
#pragma once

#include <functional>

#include "daemon/messages.h"

namespace packmerger {

Claimed claim(const ClaimOrder& order);
// on_block: called again and again while a large file is copied.
Fetched fetch(const FetchOrder& order, const std::function<void()>& on_block = {});
Placed place(const PlaceOrder& order);
Deleted clear_away(const DeleteOrder& order);
Filed file(const FileOrder& order, const std::function<void()>& on_block = {});

}  // namespace packmerger
