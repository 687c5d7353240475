// The bytes of RepRap G-code over a serial line, after Marlin's source: commands of a program,
// numbered lines with checksums, and what a printer's reply means. No port is known here.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "firmware_io/print_state.h"

namespace packmerger {

struct GcodeCommand {
  std::string_view text;  // without comment and surrounding space
  std::size_t line = 0;   // in the program, from 1
};

// The commands of a program in order; comments and empty lines are left out, because Marlin gives
// an empty line no answer. They are read from the text as they are asked for, so that a long
// program takes no further memory; the views point into it.
class GcodeCommands {
 public:
  class Iterator {
   public:
    explicit Iterator(std::string_view program) : rest_(program) { ++*this; }
    const GcodeCommand& operator*() const { return command_; }
    Iterator& operator++();
    // Of one and the same program.
    bool operator!=(const Iterator& other) const {
      return command_.text.data() != other.command_.text.data();
    }

   private:
    std::string_view rest_;
    std::size_t line_ = 0;
    GcodeCommand command_;  // behind the last: no text
  };

  explicit GcodeCommands(std::string_view program) : program_(program) {}
  Iterator begin() const { return Iterator(program_); }
  Iterator end() const { return Iterator({}); }
  std::size_t count() const;

 private:
  std::string_view program_;
};
inline GcodeCommands gcode_commands(std::string_view program) { return GcodeCommands(program); }

// Throws Error{kBadInput} as check_gcode() promises.
void check_gcode_commands(const GcodeCommands& commands);

// "N1 G28*18\n": the checksum is the exclusive or of every byte before the asterisk.
std::string numbered_gcode(std::size_t number, std::string_view command);
// The same without its line ending, as GcodeChannel::send() takes it.
std::string numbered_line(std::size_t number, std::string_view command);

// The first word of a command: "G1" of "G1 X10", "M109" of "M109 S200".
std::string_view gcode_word(std::string_view command);

bool is_heating(std::string_view command);  // blocks until a temperature is reached
bool is_long(std::string_view command);   // may block long: homing, dwelling, a macro of the user's
bool is_macro(std::string_view command);  // PRINT_START: whatever its user made of it
bool blocks(std::string_view command);    // either of them
double dwell_s(std::string_view command);       // what G4, M0 or M1 says that it will take; else 0
bool tells_position(std::string_view command);  // M114, and homing and probing at their end
bool waits_for_user(std::string_view command);  // M0 or M1 without a time

// What a printer that does not know a command of this word leaves out of a print.
enum class Omission {
  kMinor,     // the object comes out as it should, or nearly
  kOfPerson,  // somebody was to do something: change the filament, press a button
  kOfPrint    // a move, a heater, a unit or a tool: what is printed is wrong from there on
};
Omission omission_of(std::string_view word);

enum class GcodeReplyKind {
  kOk,
  kResend,        // number: the line asked for
  kBusy,          // alive; `waiting` where the printer waits for its user
  kIdle,          // "wait": alive and nothing queued
  kStart,         // booted: whatever was printing is lost
  kStopped,       // its words say that it has stopped, for good or until it is started again
  kRefused,       // Klipper's "!!": it does not do what it was told, and an ok may follow
  kError,         // an error line; what follows tells whether it is harmless
  kUnknown,       // text: the word of a command that it does not know
  kTemperature,   // a report that is no ok
  kPosition,      // "X:… Y:… Z:…", what M114 answers
  kPrompt,        // text: the question
  kPromptButton,  // text: one of its answers
  kPromptEnd,     // it asks no longer
  kPause,         // asks its host to pause; `waiting` where it stands still already
  kResume,        // goes on after a pause
  kCancel,        // the print was cancelled at its panel
  kFirmware,      // the answer to M115
  kCapability,    // text: "NAME:0" or "NAME:1"
  kCard,          // the answer to M27; `waiting` where it prints from its card
  kOther
};

struct GcodeReply {
  GcodeReplyKind kind = GcodeReplyKind::kOther;
  std::string text;        // the whole line unless said otherwise above
  std::size_t number = 0;  // of kOk: the line, where the printer names it
  bool waiting = false;
  bool heater_failed = false;         // of kStopped
  bool has_temperature = false;       // of kOk: the answer to M105
  std::vector<HeaterReport> heaters;  // of kTemperature, and of kOk with temperatures
  bool has_position = false;          // of kOk: M114 answered on one line
  bool has_firmware = false;          // of kOk: M115 answered on one line
};

// `line` without its line ending. Anything unknown is kOther, never an error.
GcodeReply read_gcode_reply(std::string_view line);

// Longest line that Marlin takes, numbering and checksum included, the line ending not.
inline constexpr std::size_t kMaxGcodeLine = 95;
// Of these a command may have so many, whatever its number: what is asked between the lines of a
// program takes numbers too, in a pause without end.
inline constexpr std::size_t kMaxGcodeCommand =
    kMaxGcodeLine - std::string_view("N99999999 *255").size();

}  // namespace packmerger
