// The tables of the jobs' database, and how those of earlier versions become today's. For
// job_store.cpp only.
#pragma once

#include <filesystem>

#include "job/store/sqlite.h"

namespace packmerger::sqlite {

// Whole or not at all. Throws Error{kIo} for a file that a newer PackMerger wrote.
void bring_up_to_date(Connection& connection, const std::filesystem::path& file);

}  // namespace packmerger::sqlite
