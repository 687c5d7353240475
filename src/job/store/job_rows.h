// A job, and the lines of its history, as rows of the database. For the files of the store only.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "job/store/job_store.h"
#include "job/store/sqlite.h"

namespace packmerger::sqlite {

// A query for jobs, whose rows read_jobs() takes.
std::string select_jobs(std::string_view condition);
std::vector<JobRecord> read_jobs(Statement& rows);  // those that are left

// Returns the id that it got; the record's is ignored.
std::int64_t insert_job(const Connection& connection, const JobRecord& job);
void update_job(const Connection& connection, const JobRecord& job);

// A line with the state that the job has now.
void write_event(const Connection& connection, const JobRecord& job, std::string_view note);
std::vector<JobEvent> read_events(const Connection& connection, std::int64_t job);

}  // namespace packmerger::sqlite
