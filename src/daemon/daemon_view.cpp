#include "daemon/daemon_view.h"

#include <fmt/format.h>

#include <algorithm>

#include "daemon/trouble_view.h"

namespace packmerger {

using nlohmann::json;

json storage_view(const Foreman& foreman) {
  const std::optional<Room>& room = foreman.cleaner().room();
  const std::optional<Announced>& announced = foreman.cleaner().announced();
  const bool announces = announced && announced->jobs > 0;
  return {{"free_bytes", room ? json(room->free_bytes) : json()},
          {"low", room && room->is_low()},
          {"keep_days", foreman.config().keep_days},
          {"keep_jobs", foreman.config().keep_jobs},
          {"announced",
           announces ? json{{"from_s", announced->from_s}, {"jobs", announced->jobs}} : json()}};
}

json troubles_view(const Foreman& foreman) { return list_of(foreman.troubles()); }

std::string daemon_status(const Foreman& foreman) {
  const std::vector<PrinterConfig>& printers = foreman.config().printers;
  const auto count = std::count_if(printers.begin(), printers.end(),
                                   [](const PrinterConfig& printer) { return !printer.is_auto(); });
  std::string text = count == 0 ? "no printer is configured"
                                : fmt::format("{} printer{}", count, count > 1 ? "s" : "");
  for (const auto& [job, preparer] : foreman.preparing())
    text += fmt::format("; preparing job {}", job);
  for (const PrinterConfig& printer : printers)
    if (const std::int64_t job = foreman.sending_at(printer.name); job != 0)
      text += fmt::format("; job {} is at {}", job, printer.name);
  for (const auto& [about, trouble] : foreman.troubles()) text += "; trouble with: " + about;
  if (const std::optional<Room>& room = foreman.cleaner().room(); room && room->is_low())
    text += fmt::format("; only {:.1f} GiB free",
                        static_cast<double>(room->free_bytes) / (std::uint64_t{1} << 30));
  return text;
}

}  // namespace packmerger
