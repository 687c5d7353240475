#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <functional>

#include "daemon/model_options.h"
#include "daemon/move_file.h"
#include "daemon/worker.h"

namespace packmerger {
namespace {

void fetch_settings(const FetchOrder& order) {
  const fs::path from = settings_beside(order.from);
  const fs::path to = settings_beside(order.to);
  if (order.with_settings && is_taken(from) && !is_taken(to)) copy_file_whole(from, to);
}

// A copy whose original cannot be removed is taken back: the file would be found again.
void fetch(const FetchOrder& order) {
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
void file(const FileOrder& order) {
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

void run_clerk(Queue<ClerkOrder>& orders, Queue<Event>& events) {
  while (const std::optional<ClerkOrder> order = orders.pop()) {
    if (const auto* wanted = std::get_if<FetchOrder>(&*order))
      events.push(Fetched{wanted->job, failure_of([&] { fetch(*wanted); })});
    else if (const auto* done = std::get_if<FileOrder>(&*order))
      events.push(Filed{done->job, failure_of([&] { file(*done); })});
  }
}

}  // namespace packmerger
