// Which jobs' folders may be deleted, as the database has it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "job/store/job_store.h"

namespace packmerger {

// Where a disk is full, jobs that ended so shortly ago keep their folders all the same.
inline constexpr double kSparedAfterEnd_s = 86400;

namespace sqlite {

class Connection;

// As JobStore's members of these names.
std::vector<JobRecord> deletable(const Connection& connection, double until_s, int limit);
std::int64_t count_deletable(const Connection& connection, double until_s);
double ended_beyond(const Connection& connection, int kept);
std::vector<JobRecord> sharing(const Connection& connection, const JobRecord& job);
std::vector<std::int64_t> to_delete(const Connection& connection);

}  // namespace sqlite

// The ids of all that JobStore::deletable() would give of this file, without a single write: for a
// disk that has no room to open it. Those that share a folder are together; the group with the one
// that ended first comes first. None where the file is not there, or is of a version that deleted
// nothing. Throws as JobStore does. Nobody else may have the file open.
std::vector<std::vector<std::int64_t>> read_deletable(const std::filesystem::path& file,
                                                      double until_s);

}  // namespace packmerger
