// The notes beside a filed model.
#pragma once

#include <string>

#include "job/store/job_store.h"

namespace packmerger {

std::string result_note(const JobRecord& job);  // JSON
std::string reason_note(const JobRecord& job);  // for people

}  // namespace packmerger
