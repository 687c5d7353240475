// What people ask the job manager for, of printers.
#include <algorithm>

#include "base/names.h"
#include "daemon/jobs/job_manager.h"

namespace packmerger {

PrinterRecord JobManager::clear(const std::string& name) {
  get_printer(name);
  if (sending_at(name) != 0)
    throw Error(Fault::kBusy, "The printer " + name + " is printing",
                "Say that its bed is clear once the print has ended and was taken out.");
  PrinterRecord printer = store_.printer(name);
  printer.bed_clear = true;
  store_.save(printer);
  log_("printer " + name + ": its bed is clear");
  return printer;
}

// Nothing where nothing is streamed there.
LiveJob* JobManager::printing_at(const std::string& printer) {
  const auto found = live_.find(sending_at(printer));
  const PrinterConfig& config = get_printer(printer);
  if (found == live_.end() || !found->second.control || config.hands_over()) return nullptr;
  return &found->second;
}

LiveJob& JobManager::get_printing(const std::string& printer) {
  if (LiveJob* live = printing_at(printer)) return *live;
  throw Error(Fault::kUsage, "The printer " + printable(printer) + " is not printing",
              "packmerger printers list shows what each of them does.");
}

PrinterRecord JobManager::pause(const std::string& name, bool paused) {
  LiveJob* live = printing_at(name);
  PrinterRecord printer = store_.printer(name);
  printer.paused = paused;
  // Whoever wants a print to stand must not wait for room on a disk.
  if (live != nullptr && paused) live->control->pause();
  store_.save(printer);
  if (live != nullptr && !paused) live->control->resume();
  log_("printer " + name + (paused ? ": paused, no new print starts" : ": resumed"));
  return printer;
}

PrinterRecord JobManager::answer(const std::string& name, int choice) {
  LiveJob& live = get_printing(name);
  if (live.print.state != PrintState::kWaiting)
    throw Error(Fault::kUsage, "The printer " + name + " asks nothing",
                "packmerger printers list shows what each of them does.");
  const auto choices = static_cast<int>(live.print.choices.size());
  if (choice < 0 || choice >= std::max(choices, 1))
    throw Error(Fault::kUsage, "The printer " + name + " offers no such choice",
                "packmerger printers list shows its choices, counted from 0.");
  live.control->answer(choice);
  log_("printer " + name + ": answered " + std::to_string(choice));
  return store_.printer(name);
}

PrinterRecord JobManager::stop_at_once(const std::string& name) {
  LiveJob& live = get_printing(name);
  live.control->stop_at_once();
  log_("printer " + name + ": stopped at once");
  return store_.printer(name);
}

}  // namespace packmerger
