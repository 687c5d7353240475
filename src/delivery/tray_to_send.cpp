#include "delivery/tray_to_send.h"

#include <fmt/format.h>

#include "base/error.h"
#include "delivery/job_folder.h"
#include "model/files/job_folder_names.h"

namespace packmerger {

fs::path tray_to_send(const fs::path& folder, const Profile& profile, int tray) {
  const fs::path file = folder / tray_file(profile, tray);
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored))
    throw Error(Fault::kNoInput,
                fmt::format("The file of tray {}, {}, is not there any more", tray,
                            file.filename().string()),
                kPrepareAnew);
  return file;
}

void check_hash(const std::string& sha256, const std::string& tray_files, int tray,
                const fs::path& file) {
  const std::string recorded = hash_of_tray(tray_files, tray);
  if (!recorded.empty() && sha256 != recorded)
    throw Error(Fault::kBadInput,
                fmt::format("The file of tray {}, {}, is not what was prepared (its bytes were "
                            "changed)",
                            tray, file.filename().string()),
                kPrepareAnew);
}

}  // namespace packmerger
