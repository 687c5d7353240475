// The table of what becomes of a job, by itself and as docs/ARCHITECTURE draws it.
#include "job/store/job_transitions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "base/files.h"

namespace packmerger {
namespace {

constexpr int kEvents = static_cast<int>(JobEventKind::kDeleted) + 1;
constexpr int kActions = static_cast<int>(JobAction::kEnd) + 1;
constexpr int kStates = static_cast<int>(JobState::kCancelled) + 1;

std::vector<std::optional<JobState>> all_states() {
  std::vector<std::optional<JobState>> states = {std::nullopt};
  for (int i = 0; i < kStates; ++i) states.emplace_back(static_cast<JobState>(i));
  return states;
}

bool knows(const JobTransition& row, const std::optional<JobState>& from) {
  return from ? row.from.contains(*from) : row.from.is_empty();
}

TEST(JobTransitions, AStateAndAnEventHaveOneRowAtMost) {
  for (const std::optional<JobState>& from : all_states())
    for (int event = 0; event < kEvents; ++event) {
      const auto kind = static_cast<JobEventKind>(event);
      const auto rows =
          std::count_if(kJobTransitions.begin(), kJobTransitions.end(),
                        [&](const auto& row) { return row.event == kind && knows(row, from); });
      EXPECT_LE(rows, 1) << event_name(kind);
      EXPECT_EQ(transition_of(from, kind) != nullptr, rows == 1) << event_name(kind);
    }
}

TEST(JobTransitions, EveryEventAndActionHasARowAndANameOfItsOwn) {
  std::set<std::string_view> events, actions, names, action_names;
  for (const JobTransition& row : kJobTransitions) {
    events.insert(event_name(row.event));
    actions.insert(action_name(row.action));
  }
  for (int i = 0; i < kEvents; ++i) names.insert(event_name(static_cast<JobEventKind>(i)));
  for (int i = 0; i < kActions; ++i) action_names.insert(action_name(static_cast<JobAction>(i)));
  EXPECT_EQ(events, names);
  EXPECT_EQ(names.size(), static_cast<std::size_t>(kEvents));
  EXPECT_EQ(actions, action_names);
  EXPECT_EQ(action_names.size(), static_cast<std::size_t>(kActions));
}

TEST(JobTransitions, WhatHasEndedStaysAndWhatEndsIsFiled) {
  for (const JobTransition& row : kJobTransitions) {
    const bool ends = row.to && has_ended(*row.to);
    EXPECT_EQ(ends, row.action == JobAction::kEnd) << event_name(row.event);
    for (const JobState from :
         {JobState::kDone, JobState::kHandedOver, JobState::kFailed, JobState::kCancelled})
      EXPECT_FALSE(row.from.contains(from) && row.to) << event_name(row.event);
  }
}

std::string name_of(const std::optional<JobState>& state) {
  return state ? std::string(state_name(*state)) : "[*]";
}

// "tray printed / next tray", as state charts have it.
std::string label_of(const JobTransition& row) {
  const std::string action(action_name(row.action));
  return std::string(event_name(row.event)) + (action.empty() ? "" : " / " + action);
}

// The drawing has an arrow for each change of state, with all events that make it.
std::vector<std::string> arrows_of_the_table() {
  std::map<std::pair<std::string, std::string>, std::string> arrows;
  for (const JobTransition& row : kJobTransitions)
    for (const std::optional<JobState>& from : all_states()) {
      const bool is_forgotten = row.action == JobAction::kForgetJob;
      if (!knows(row, from) || (!is_forgotten && row.to.value_or(*from) == from)) continue;
      std::string& labels = arrows[{name_of(from), is_forgotten ? "[*]" : name_of(row.to)}];
      labels += (labels.empty() ? "" : ", ") + label_of(row);
    }
  std::vector<std::string> lines;
  for (const auto& [states, labels] : arrows)
    lines.push_back(states.first + " --> " + states.second + ": " + labels);
  return lines;
}

// Below it a line for each event that leaves a job where it is.
std::vector<std::string> stays_of_the_table() {
  std::vector<std::string> lines;
  for (const JobTransition& row : kJobTransitions) {
    std::string states;
    for (const std::optional<JobState>& from : all_states())
      if (knows(row, from) && row.action != JobAction::kForgetJob && row.to.value_or(*from) == from)
        states += (states.empty() ? "" : ", ") + name_of(from);
    if (!states.empty())
      lines.push_back("| " + states + " | " + std::string(event_name(row.event)) + " | " +
                      std::string(action_name(row.action)) + " |");
  }
  return lines;
}

std::vector<std::string> lines_of_the_docs(const std::string& mark) {
  const char* source = std::getenv("PACKMERGER_SOURCE");
  const std::string page =
      read_file(fs::path(source == nullptr ? "." : source) / "docs/ARCHITECTURE.md", 1 << 20);
  const std::size_t section = page.find("\n## A job's states\n");
  EXPECT_NE(section, std::string::npos);
  const std::size_t end = std::min(page.find("\n## ", section + 2), page.size());
  std::vector<std::string> lines;
  for (std::size_t at = section; at < end;) {
    const std::size_t next = std::min(page.find('\n', at), end);
    std::string line = page.substr(at, next - at);
    line.erase(0, line.find_first_not_of(' '));
    const bool is_head = line.starts_with("| in |") || line.starts_with("|---");
    if (!is_head && line.find(mark) != std::string::npos) lines.push_back(line);
    at = next + 1;
  }
  return lines;
}

TEST(JobTransitions, TheDrawingShowsEachChangeOfState) {
  EXPECT_THAT(lines_of_the_docs(" --> "), testing::UnorderedElementsAreArray(arrows_of_the_table()))
      << testing::PrintToString(arrows_of_the_table());
}

TEST(JobTransitions, TheListBelowItHasEachEventThatChangesNoState) {
  EXPECT_THAT(lines_of_the_docs("| "), testing::UnorderedElementsAreArray(stays_of_the_table()))
      << testing::PrintToString(stays_of_the_table());
}

}  // namespace
}  // namespace packmerger
