// Traps that firmwares set, each by name and each one of its own, so that a test can set one alone.
// docs/PROTOCOLS lists what was seen of them.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace packmerger::simulated {

// As given here: Marlin 2.1 with its emergency parser and host prompts.
struct MarlinTraits {
  std::string version = "2.1.2";
  bool doubled_silent = true;      // a line it has already gets no answer; otherwise Resend
  bool rx_overflow = false;        // what does not fit its receive ring (128 bytes) is lost
  bool emergency_parser = true;    // M108, M112, M410 and M876 act while they are received
  bool prompts = true;             // asks its user through the host
  bool busy = true;                // says "busy" every two seconds while a command blocks
  bool crlf = true;                // some lines end "\r\n"
  bool m110_anywhere = true;       // a numbered line with "M110" anywhere sets the line count
  bool advanced_ok = false;        // "ok N2 P14 B3"
  bool idle_wait = false;          // says "wait" every second while it has nothing to do
  bool autoreport = true;          // tells its temperatures of its own once asked to (M155)
  bool reports_unasked = false;    // does so every second from its start
  bool resend_error = true;        // an "Error:" line before "Resend"
  bool resend_ok = true;           // an "ok" behind it
  bool resend_short = false;       // "rs N3" for "Resend: 3"
  bool filament_change = true;     // knows M600, and asks its user twice; else an unknown command
  bool positions_unasked = false;  // tells its position every second from its start, as by M154 S1
  bool chatters = false;           // says every second from its start what means nothing
  bool heats_quietly = false;      // waits for heat with neither "busy" nor "W:", as Klipper does
  bool doubled_ok = false;         // every fifth ok comes twice
  bool counts_lines = true;        // else it looks at neither number nor checksum, nor asks for a
                                   // line, and says ok to an empty one, as Klipper does
  bool checks_sums = false;    // where it counts no lines: it asks for one whose sum is wrong, by
                               // that line's own number, as old RepRapFirmware does
  bool drops_garbled = false;  // such a line it drops in silence, as RepRapFirmware 3 does
  bool counts_relative_e =
      true;                    // in M114; else E stays in relative mode, as RepRapFirmware's does
  bool refuses_raw = false;    // once a line was numbered, one that is not (but M112) is asked for
  bool macros = false;         // a command that begins with a word takes eight seconds
  bool comment_blank = false;  // "// action:", "// Unknown command:", as Klipper writes them
  // What it does once, with the line that it executes as the n-th since it booted; 0: never.
  std::size_t stops_at = 0;    // "!! STOP called": it obeys, but moves no more until M999
  std::size_t fatal_at = 0;    // says "fatal:" and goes on answering, as Repetier's firmware does
  std::size_t refuses_at = 0;  // the next move, with "!!" and an ok, as Klipper does
};

MarlinTraits marlin_1_1();
MarlinTraits klipper();

// As given here: Sailfish 7.8.
struct ReplicatorTraits {
  bool noise_endless = true;     // a stray byte is answered 0x80 until a packet comes; else once
  bool unknown_accepted = true;  // an unknown action is answered 0x81, then the build is lost
  bool version_hidden = true;    // from hosts below version 39
  bool counts_actions = false;   // build statistics tell how many were executed (LINE_NUMBER)
  bool packet_timeout = true;    // a packet cut short is answered 0x8C after 0.2 s
};

// "rx_overflow", "rx_overflow=on" or "rx_overflow=off"; "stops_at=40" or "stops_at=off". False
// where there is no such trait.
bool set_trait(MarlinTraits& traits, std::string_view text);
bool set_trait(ReplicatorTraits& traits, std::string_view text);

// For help texts: of the traits that are on or off, and of those that name a line.
std::vector<std::string> marlin_trait_names();
std::vector<std::string> marlin_line_trait_names();
std::vector<std::string> replicator_trait_names();

}  // namespace packmerger::simulated
