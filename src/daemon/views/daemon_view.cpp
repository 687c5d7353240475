#include "daemon/views/daemon_view.h"

#include <fmt/format.h>

#include <algorithm>

#include "daemon/views/trouble_view.h"

namespace packmerger {

using nlohmann::json;

json storage_view(const JobManager& job_manager) {
  const std::optional<Room>& room = job_manager.cleaner().room();
  const std::optional<Announced>& announced = job_manager.cleaner().announced();
  const bool announces = announced && announced->jobs > 0;
  return {{"free_bytes", room ? json(room->free_bytes) : json()},
          {"low", room && room->is_low()},
          {"keep_days", job_manager.config().keep_days},
          {"keep_jobs", job_manager.config().keep_jobs},
          {"announced",
           announces ? json{{"from_s", announced->from_s}, {"jobs", announced->jobs}} : json()}};
}

json troubles_view(const JobManager& job_manager) { return list_of(job_manager.troubles()); }

std::string daemon_status(const JobManager& job_manager) {
  const std::vector<PrinterConfig>& printers = job_manager.config().printers;
  const auto count = std::count_if(printers.begin(), printers.end(),
                                   [](const PrinterConfig& printer) { return !printer.is_auto(); });
  std::string text = count == 0 ? "no printer is configured"
                                : fmt::format("{} printer{}", count, count > 1 ? "s" : "");
  for (const auto& [job, preparer] : job_manager.preparing())
    text += fmt::format("; preparing job {}", job);
  for (const PrinterConfig& printer : printers)
    if (const std::int64_t job = job_manager.sending_at(printer.name); job != 0)
      text += fmt::format("; job {} is at {}", job, printer.name);
  for (const auto& [about, trouble] : job_manager.troubles()) text += "; trouble with: " + about;
  if (const std::optional<Room>& room = job_manager.cleaner().room(); room && room->is_low())
    text += fmt::format("; only {:.1f} GiB free",
                        static_cast<double>(room->free_bytes) / (std::uint64_t{1} << 30));
  return text;
}

}  // namespace packmerger
