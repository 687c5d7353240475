// What a folder worker does with files: taking them for jobs, copying and filing them. Each order
// is done on the calling thread, and answered with what the loop is to be told; nothing is thrown.
#pragma once

#include "daemon/orders/messages.h"

namespace packmerger {

Claimed claim(const ClaimOrder& order);
Fetched fetch(const FetchOrder& order);
Placed place(const PlaceOrder& order);
Deleted clear_away(const DeleteOrder& order);
Filed file(const FileOrder& order);

}  // namespace packmerger
