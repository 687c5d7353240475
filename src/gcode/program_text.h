// What a file that somebody calls a program holds. It is told by the bytes, whatever its name says.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace packmerger {

// The G-code in a file: the bytes themselves, without a byte order mark, with "\n" where the file
// ends its lines by "\r" alone; of a ZIP archive as Orca and Bambu Studio write it (.gcode.3mf) the
// program of its one plate. Comments may be in any encoding. Throws Error{kBadInput} where it is
// something else, naming what it is and what to do: binary G-code, UTF-16, what is compressed, an
// archive without a program or with several plates, other binary data, a web page.
std::string program_text(std::string bytes);

// The programs in such an archive ("Metadata/plate_1.gcode"), in the order of their names; none
// for other archives, and for what is no archive.
std::vector<std::string> sliced_plates(std::string_view bytes);

}  // namespace packmerger
