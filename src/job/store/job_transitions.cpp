#include "job/store/job_transitions.h"

namespace packmerger {
namespace {

constexpr std::array kEventNames = std::to_array<std::string_view>({
    "arrived",
    "uploaded",
    "file again",
    "program again",
    "taken",
    "on another disk",
    "not taken",
    "file gone",
    "comparing begins",
    "preparing begins",
    "unpreparable",
    "hashed",
    "proposed",
    "fits nowhere",
    "prepared",
    "preparing failed",
    "approve",
    "approve by itself",
    "approved before",
    "hold",
    "release",
    "put first",
    "prepare otherwise",
    "replace",
    "cancel",
    "tray begins",
    "tray not begun",
    "begun after all",
    "tray printed",
    "last tray printed",
    "handed over",
    "print failed",
    "print cancelled",
    "stopped",
    "died",
    "died before the tray",
    "died too often",
    "order expired",
    "broken",
    "placed",
    "name taken",
    "filed",
    "delete",
    "deleted",
});

constexpr std::array kActionNames = std::to_array<std::string_view>({
    "",
    "forget the job",
    "copy",
    "count the attempt",
    "forget what was prepared",
    "forget deaths",
    "forget tries",
    "approve",
    "approve by hand",
    "hold",
    "release",
    "release to print",
    "begin the tray",
    "next tray",
    "note the cancel",
    "drop the order",
    "file",
    "note the wish",
    "note it is gone",
    "end",
});

static_assert(kEventNames.size() == static_cast<std::size_t>(JobEventKind::kDeleted) + 1);
static_assert(kActionNames.size() == static_cast<std::size_t>(JobAction::kEnd) + 1);

}  // namespace

const JobTransition* transition_of(std::optional<JobState> from, JobEventKind event) {
  for (const JobTransition& row : kJobTransitions)
    if (row.event == event && (from ? row.from.contains(*from) : row.from.is_empty())) return &row;
  return nullptr;
}

std::string_view event_name(JobEventKind event) {
  return kEventNames.at(static_cast<std::size_t>(event));
}

std::string_view action_name(JobAction action) {
  return kActionNames.at(static_cast<std::size_t>(action));
}

}  // namespace packmerger
