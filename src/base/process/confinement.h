// What a child process may not do although its user may: speak over a network, write outside some
// folders, change modes, owners, times or attributes of any file, open devices, signal, slow down,
// look into or change processes that are not below it. Linux: a seccomp filter made by libseccomp,
// and Landlock for the files. Both hold for everything the child starts, and cannot be taken back.
// It may send signals to its own process group alone, as kill(0, …): whoever wants to end another
// group of its session joins it first (signal_group of base/process/process.h does). It may
// abort(); what it starts dies of that in another way, by a segmentation fault.
#pragma once

#include <filesystem>
#include <vector>

#include "base/descriptor.h"

namespace packmerger {

// True where the kernel can keep a process from writing outside its folders (Landlock, Linux 5.13);
// where it cannot, the rest is kept all the same.
bool can_confine_files();

class Confinement {
 public:
  // Everything but devices may be read; only what lies below `writable`, and /dev/null, may be
  // written, removed or renamed. The folders must be there. Throws Error{kInternal} when the kernel
  // refuses.
  explicit Confinement(const std::vector<std::filesystem::path>& writable);

  // In the child between fork and exec: makes only async-signal-safe calls. The caller, who must
  // not lead a process group, becomes the leader of a session and a group. False, with errno set,
  // where the kernel refuses.
  bool apply() const;

 private:
  Descriptor files_;         // a Landlock ruleset; none where the kernel has none
  std::vector<char> calls_;  // a seccomp program, sock_filter by sock_filter
};

}  // namespace packmerger
