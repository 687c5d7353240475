#!/usr/bin/python3
"""The rules of the house that a script can see: who includes whom, lengths, words, headers (docs/ARCHITECTURE)."""
import collections
import functools
import os
import pathlib
import re
import sys
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
CODE = {".h", ".cpp"}
TEXT = CODE | {".py", ".js", ".ts", ".md", ".toml", ".txt", ".cmake", ".sh", ".json", ".html", ".css", ".tsx", ".service", ".rules"}
SKIPPED_FOLDERS = {"build", "node_modules", ".git", "__pycache__"}

OWNERS = {r"tetgen\.h": "one file", r"GL/osmesa\.h": "offscreen", r"microhttpd\.h": "http",
          r"(curl/.*|MQTTClient|avahi-.*)\.h": "notify"}

LONG_LINES, TOO_LONG_LINES = 300, 450
MOST_FILES = 25
# spelled in pieces, so that this file does not contain them
FORBIDDEN = ["/wo" + "rk/", "sub" + "agent", r"\bTO" + r"DO\b", r"\bFIX" + r"ME\b", r"\bXX" + r"X\b"]


def table_rows(page, *columns):
    """The rows of the page's table with these columns, cell by cell."""
    lines = (SOURCE / page).read_text(encoding="utf-8").splitlines()
    first = lines.index("| " + " | ".join(columns) + " |") + 2
    for line in lines[first:]:
        if not line.startswith("|"):
            return
        yield [cell.strip() for cell in line.strip("|").split("|")]


def words_in(cell):
    return set(re.findall(r"[\w/]+", cell))


def rooms():
    """The rooms of docs/ARCHITECTURE that hold C++, and what each may include: those named, or "everything but" them."""
    rows = {name.strip("`").removeprefix("src/"): words_in(allowed)
            for name, _, allowed in table_rows("docs/ARCHITECTURE.md", "folder", "what it holds", "may include")}
    return {name: set(rows) - words if "everything" in words else words & set(rows)
            for name, words in rows.items() if words and name != "tests"}


def house_of(room):
    """Its folder: src/shape, printers."""
    return SOURCE / ("src" if (SOURCE / "src" / room).is_dir() else "") / room


def inner_rooms(room):
    """The folders of a room as its README lists them, and which others of the room each may include."""
    readme = house_of(room) / "README.md"
    if not readme.exists():
        return {}
    rows = {name.strip("`"): words_in(allowed)
            for name, _, allowed in table_rows(readme, "folder", "what lives there", "may include")}
    return {name: set(rows) - words if "everything" in words else words for name, words in rows.items()}


MAY_INCLUDE = rooms()
FOLDERS = set(MAY_INCLUDE)


@functools.cache
def all_files():
    """Files of the source tree; build trees and packages are left out, and not looked into."""
    found = []
    for folder, inner, names in os.walk(SOURCE):
        inner[:] = [name for name in inner
                    if name not in SKIPPED_FOLDERS and (not name.startswith("build") or name == "build_rules")]
        found += [pathlib.Path(folder, name) for name in names]
    return sorted(found)


def files(*suffixes):
    return [path for path in all_files() if path.suffix in suffixes]


def folder_of(path):
    """"shape" for src/shape/surface/repair.cpp, "printers" for printers/slice/slice.cpp; None elsewhere."""
    parts = path.relative_to(SOURCE).parts
    name = parts[1] if parts[0] == "src" and len(parts) > 2 else parts[0]
    return name if name in FOLDERS else None


def includes(path):
    return re.findall(r'^\s*#\s*include\s*[<"]([^">]+)[">]', path.read_text(encoding="utf-8"), re.MULTILINE)


def house_code():
    return [(path, folder_of(path)) for path in files(*CODE) if folder_of(path)]


def name_of(path):
    return str(path.relative_to(SOURCE))


def inner_folder(name):
    """"surface" for shape/surface/repair.h, "web/doors" for daemon/web/doors/door.h, "shape" for shape/shape.h."""
    room, *inner, _ = name.split("/")
    return "/".join(inner) or room


class Includes(unittest.TestCase):
    def test_there_is_code(self):
        self.assertGreater(len(house_code()), 20)

    def test_folders_include_what_the_table_allows(self):
        wrong = []
        for path, folder in house_code():
            allowed = MAY_INCLUDE[folder] | {folder}
            for included in includes(path):
                target = included.split("/")[0]
                if target in FOLDERS and target not in allowed:
                    wrong.append(f"{name_of(path)} includes {included}")
        self.assertEqual(wrong, [])

    def test_folders_of_a_room_include_what_its_readme_allows(self):
        """Downwards only; the room's own files are the row that has the room's name."""
        wrong = []
        for room in FOLDERS:
            allowed = inner_rooms(room)
            for path, folder in house_code():
                if folder != room:
                    continue
                inner = inner_folder(name_of(path).removeprefix("src/"))
                for included in includes(path) if allowed else []:
                    if not included.startswith(room + "/"):
                        continue
                    target = inner_folder(included)
                    if target != inner and target not in allowed.get(inner, set()):
                        wrong.append(f"{name_of(path)} includes {included}")
        self.assertEqual(wrong, [])

    def test_inner_folders_are_listed_and_make_no_circle(self):
        for room in FOLDERS:
            there = {inner_folder(name_of(path).removeprefix("src/")) for path, folder in house_code() if folder == room}
            left = inner_rooms(room)
            self.assertEqual(there if len(there) > 1 else set(left), set(left), f"{room}: what is there, and what its README lists")
            while left:
                lowest = {name for name, allowed in left.items() if not (allowed - {name}) & set(left)}
                self.assertTrue(lowest, f"{room}: these include one another: {sorted(left)}")
                left = {name: allowed for name, allowed in left.items() if name not in lowest}

    def test_own_headers_are_named_with_their_folder(self):
        wrong = []
        for path, _ in house_code():
            for included in includes(path):
                if included.startswith(".") or ("/" not in included and (path.parent / included).exists()):
                    wrong.append(f"{name_of(path)} includes {included}")
        self.assertEqual(wrong, [])

    def test_links_follow_the_table(self):
        """target_link_libraries spells the same rules."""
        wrong = []
        for folder, allowed in MAY_INCLUDE.items():
            listing = house_of(folder) / "CMakeLists.txt"
            text = re.sub(r"#.*", "", listing.read_text(encoding="utf-8"))
            library = re.search(rf"packmerger_library\(packmerger_{folder}\b(.*?)\)", text, re.DOTALL)
            linked = set(re.findall(r"\bpackmerger_(\w+)", library.group(1))) & FOLDERS if library else set()
            wrong += [f"{folder} links {other}" for other in sorted(linked - allowed - {folder})]
        self.assertEqual(wrong, [])

    def test_one_file_includes_tetgen(self):
        users = [name_of(path) for path, _ in house_code() if "tetgen.h" in includes(path)]
        self.assertEqual(len(users), 1, users)
        self.assertTrue(users[0].startswith("src/shape/"), users)

    def test_wrapped_libraries_have_one_folder(self):
        for pattern, owner in OWNERS.items():
            users = {folder for path, folder in house_code() for included in includes(path) if re.fullmatch(pattern, included)}
            if owner in FOLDERS:
                self.assertEqual(users, {owner}, pattern)

    def test_only_offscreen_includes_osmesa(self):
        users = {folder for path, folder in house_code() for included in includes(path)
                 if re.match(r"GL/", included)}
        self.assertEqual(users, {"offscreen"})

    def test_simulated_printers_share_no_codec_with_the_links(self):
        """One must not hide the other's mistake."""
        wrong = []
        for path, folder in house_code():
            simulated = "simulated" in path.relative_to(SOURCE).parts
            for included in includes(path) if folder == "firmware_io" else []:
                codec = re.match(r"firmware_io/(gcode|s3g|usb)/", included)
                if (simulated and codec) or (not simulated and included.startswith("firmware_io/simulated/")):
                    wrong.append(f"{name_of(path)} includes {included}")
        self.assertEqual(wrong, [])

    def test_only_the_tables_ask_for_a_dialect(self):
        """Whoever else asks would have to be found again when a way of delivery comes."""
        asking = [name_of(path) for path, folder in house_code()
                  if "Dialect::" in path.read_text(encoding="utf-8")
                  and not name_of(path).startswith(("src/model/", "src/delivery/ways/"))]
        self.assertEqual(asking, [])

    def test_program_code_includes_no_tests(self):
        wrong = [f"{name_of(path)} includes {included}" for path, _ in house_code() for included in includes(path)
                 if included.startswith(("tests/", "fixtures/", "gtest/", "gmock/", "rapidcheck"))]
        self.assertEqual(wrong, [])


class Files(unittest.TestCase):
    def test_lengths(self):
        lengths = {name_of(path): len(path.read_text(encoding="utf-8").splitlines())
                   for path in files(*CODE, ".py", ".ts", ".tsx", ".js", ".css")}
        for name, lines in lengths.items():
            if lines > LONG_LINES:
                print(f"long: {name} has {lines} lines, {LONG_LINES} are aimed at", file=sys.stderr)
        self.assertEqual([f"{name}: {lines}" for name, lines in lengths.items() if lines > TOO_LONG_LINES], [])

    def test_no_folder_grows_beyond_what_can_be_looked_over(self):
        """src/cli is one file a verb."""
        full = {}
        for room in FOLDERS - {"cli"}:
            own = collections.Counter(path.parent for path in all_files() if house_of(room) in path.parents)
            full |= {str(folder.relative_to(SOURCE)): count for folder, count in own.items() if count > MOST_FILES}
        self.assertEqual(full, {})

    def test_no_forbidden_words(self):
        found = []
        for path in files(*TEXT):
            for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
                found += [f"{name_of(path)}:{number}: {word}" for word in FORBIDDEN if re.search(word, line)]
        self.assertEqual(found, [])

    def test_headers_begin_with_what_they_are(self):
        silent = []
        for path in files(".h"):
            text = path.read_text(encoding="utf-8")
            # What Highway includes once for each target guards itself.
            guarded = "#pragma once" in text or "HWY_TARGET_TOGGLE" in text
            if not text.startswith("// ") or not guarded or re.search(r"^using namespace", text, re.MULTILINE):
                silent.append(name_of(path))
        self.assertEqual(silent, [])

    def test_top_level_folders(self):
        known = {"src", "printers", "profiles", "firmware_io", "tests", "docs", "node_modules"}
        extra = [path.name for path in SOURCE.iterdir()
                 if path.is_dir() and path.name not in known and not path.name.startswith((".", "build"))]
        self.assertEqual(extra, [])


if __name__ == "__main__":
    unittest.main()
