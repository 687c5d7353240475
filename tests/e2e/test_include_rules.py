#!/usr/bin/python3
"""The rules of the house that a script can see: who includes whom, lengths, words, headers (docs/ARCHITECTURE)."""
import pathlib
import re
import sys
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
CODE = {".h", ".cpp"}
TEXT = CODE | {".py", ".js", ".ts", ".md", ".toml", ".txt", ".cmake", ".sh", ".json", ".html", ".css", ".tsx", ".service", ".rules"}
SKIPPED_FOLDERS = {"build", "node_modules", ".git", "__pycache__"}

MAY_INCLUDE = {
    "base": set(),
    "model": {"base"},
    "offscreen": {"model", "base"},
    "shape": {"model", "base"},
    "gcode": {"base"},
    "printers": {"gcode", "model", "base"},
    "pack": {"model", "base"},
    "picture": {"offscreen", "model", "base"},
    "tray": {"picture", "model", "base"},
    "firmware_io": {"gcode", "base"},
    "http": {"base"},
    "notify": {"base"},
    "job": {"tray", "picture", "pack", "printers", "gcode", "shape", "offscreen", "model", "base"},
}
EVERYTHING = {"daemon", "cli", "install"}
FOLDERS = set(MAY_INCLUDE) | EVERYTHING
OWNERS = {r"tetgen\.h": "one file", r"GL/osmesa\.h": "offscreen", r"microhttpd\.h": "http",
          r"(curl/.*|MQTTClient|avahi-.*)\.h": "notify"}

LONG_LINES, TOO_LONG_LINES = 300, 450
# spelled in pieces, so that this file does not contain them
FORBIDDEN = ["/wo" + "rk/", "sub" + "agent", r"\bTO" + r"DO\b", r"\bFIX" + r"ME\b", r"\bXX" + r"X\b"]


def files(*suffixes):
    """Files of the source tree with their folder's short name; build trees and packages are left out."""
    for path in sorted(SOURCE.rglob("*")):
        parts = path.relative_to(SOURCE).parts
        hidden = any(part in SKIPPED_FOLDERS or part.startswith("build") and part != "build_rules" for part in parts[:-1])
        if path.is_file() and not hidden and path.suffix in suffixes:
            yield path


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


class Includes(unittest.TestCase):
    def test_there_is_code(self):
        self.assertGreater(len(house_code()), 20)

    def test_folders_include_what_the_table_allows(self):
        wrong = []
        for path, folder in house_code():
            allowed = FOLDERS if folder in EVERYTHING else MAY_INCLUDE[folder] | {folder}
            for included in includes(path):
                target = included.split("/")[0]
                if target in FOLDERS and target not in allowed:
                    wrong.append(f"{name_of(path)} includes {included}")
        self.assertEqual(wrong, [])

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
            listing = SOURCE / ("src" if (SOURCE / "src" / folder).is_dir() else "") / folder / "CMakeLists.txt"
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
                codec = re.match(r"firmware_io/(gcode|s3g|usb)\w*\.h", included)
                if (simulated and codec) or (not simulated and included.startswith("firmware_io/simulated/")):
                    wrong.append(f"{name_of(path)} includes {included}")
        self.assertEqual(wrong, [])

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
            if not text.startswith("// ") or "#pragma once" not in text or re.search(r"^using namespace", text, re.MULTILINE):
                silent.append(name_of(path))
        self.assertEqual(silent, [])

    def test_top_level_folders(self):
        known = {"src", "printers", "profiles", "firmware_io", "tests", "docs", "node_modules"}
        extra = [path.name for path in SOURCE.iterdir()
                 if path.is_dir() and path.name not in known and not path.name.startswith((".", "build"))]
        self.assertEqual(extra, [])


if __name__ == "__main__":
    unittest.main()
