#include "daemon/intake/folder_actions.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <functional>

#include "base/names.h"
#include "base/storage/move_file.h"
#include "daemon/intake/beside.h"

namespace packmerger {
namespace {

void remove_if_same(const fs::path& original, const fs::path& copy) {
  std::error_code failed;
  if (!is_taken(original)) return;
  const bool same = fs::file_size(original, failed) == fs::file_size(copy, failed) && !failed &&
                    sha256_hex_of_file(original) == sha256_hex_of_file(copy);
  if (same) fs::remove(original, failed);
}

// The model first; its settings follow it, unless they were copied before it.
ClaimOutcome take(const ClaimOrder& order) {
  if (!is_taken(order.to) && rename_new(order.from, order.to) == Moved::kOtherFileSystem)
    return ClaimOutcome::kOtherFileSystem;
  const fs::path settings = settings_beside(order.to);
  if (order.with_settings && !is_taken(settings) && has_settings_beside(order.from))
    rename_new(settings_beside(order.from), settings);
  if (order.by_copy) remove_if_same(order.from, order.to);
  if (order.by_copy && order.with_settings) remove_if_same(settings_beside(order.from), settings);
  return ClaimOutcome::kTaken;
}

void fetch_settings(const FetchOrder& order) {
  const fs::path from = settings_beside(order.from);
  const fs::path to = settings_beside(order.to);
  if (order.with_settings && is_taken(from) && !is_taken(to)) copy_file_whole(from, to);
}

// A copy whose original cannot be removed is taken back: the file would be found again.
void copy_here(const FetchOrder& order) {
  fetch_settings(order);
  copy_file_whole(order.from, order.to);
  if (order.keep) return;
  if (::unlink(order.from.c_str()) == 0) {
    if (order.with_settings) ::unlink(settings_beside(order.from).c_str());
    sync_folder(order.from.parent_path());
    return;
  }
  const std::string why = std::strerror(errno);
  ::unlink(order.to.c_str());
  ::unlink(settings_beside(order.to).c_str());
  throw Error(Fault::kCannotWrite, "Cannot take " + printable(order.from.string()) + ": " + why,
              "Give the daemon's user the right to write to the watched folder.");
}

// The model first: where its name is taken by now, nothing of it may have been put there.
void put_away(const FileOrder& order) {
  if (fs::exists(order.from)) move_new(order.from, order.to);
  const fs::path settings = settings_beside(order.from);
  if (order.with_settings && is_taken(settings)) {
    const fs::path beside = settings_beside(order.to);
    move_new(settings, is_taken(beside)
                           ? free_path(beside.parent_path(), beside.filename().string())
                           : beside);
  }
  const fs::path picture = picture_beside(order.to);
  if (is_taken(order.picture) && !is_taken(picture)) copy_file_whole(order.picture, picture);
  write_file_whole(order.note, order.note_text);
}

// Under another name first, so that what is left where this is cut short is no job's folder.
void delete_whole(const fs::path& folder) {
  fs::path gone = folder;
  gone += ".deleted";
  fs::remove_all(gone);
  if (fs::exists(folder)) fs::rename(folder, gone);
  fs::remove_all(gone);
}

std::optional<Failure> failure_of(const std::function<void()>& work) {
  try {
    work();
    return std::nullopt;
  } catch (const Error& error) {
    return Failure{error.fault(), error.what(), error.hint()};
  } catch (const std::exception& error) {
    return Failure{Fault::kInternal, error.what(), "Look into the daemon's messages."};
  }
}

}  // namespace

Claimed claim(const ClaimOrder& order) {
  Claimed claimed{order.job, ClaimOutcome::kFailed, {}};
  if (const auto failure = failure_of([&] { claimed.outcome = take(order); })) {
    claimed.failure = *failure;
    if (failure->fault == Fault::kNoInput) claimed.outcome = ClaimOutcome::kGone;
  }
  return claimed;
}

Fetched fetch(const FetchOrder& order) {
  return {order.job, failure_of([&] { copy_here(order); })};
}

Placed place(const PlaceOrder& order) {
  Placed placed{order.job, {}, {}};
  placed.failure = failure_of([&] { placed.to = free_path(order.folder, order.name); });
  return placed;
}

Deleted clear_away(const DeleteOrder& order) {
  Deleted deleted;
  for (std::size_t i = 0; i < order.jobs.size(); ++i) {
    const auto failure = failure_of([&] { delete_whole(order.folders.at(i)); });
    (failure ? deleted.left : deleted.jobs).push_back(order.jobs[i]);
    if (failure && !deleted.failure) deleted.failure = failure;
  }
  return deleted;
}

Filed file(const FileOrder& order) {
  return {order.job, failure_of([&] { put_away(order); })};
}

}  // namespace packmerger
