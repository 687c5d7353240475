#!/usr/bin/python3
"""Links in README and docs lead somewhere: files exist, headings too."""
import pathlib
import re
import unittest
from urllib.parse import unquote

SOURCE = pathlib.Path(__file__).resolve().parents[2]
PAGES = ("ARCHITECTURE", "PROFILES", "JOB_FOLDER", "PROTOCOLS", "ESTIMATES", "CHANGES")
LINK = re.compile(r"!?\[[^\]]*\]\(\s*<?([^)\s>]+)>?[^)]*\)|^\[[^\]]+\]:\s*(\S+)|(?:src|href)=\"([^\"]+)\"", re.MULTILINE)


def prose(path):
    """The page without code, where brackets mean something else."""
    text = re.sub(r"^```.*?^```", "", path.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE)
    return re.sub(r"`[^`\n]*`", "", text)


def anchors(path):
    """Headings as they are linked to: lower case, words joined by hyphens."""
    text = re.sub(r"^```.*?^```", "", path.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE)
    names = set()
    for heading in re.findall(r"^#+\s+(.*?)\s*#*$", text, re.MULTILINE):
        name = re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")
        number = 0
        while (name if number == 0 else f"{name}-{number}") in names:
            number += 1
        names.add(name if number == 0 else f"{name}-{number}")
    return names


def pages():
    return [path for path in [SOURCE / "README.md", *sorted((SOURCE / "docs").glob("**/*.md"))] if path.exists()]


class Docs(unittest.TestCase):
    def test_every_page_is_there(self):
        missing = [name for name in PAGES if not (SOURCE / "docs" / f"{name}.md").is_file()]
        self.assertEqual(missing, [])
        self.assertTrue((SOURCE / "README.md").is_file())
        self.assertTrue((SOURCE / "LICENSE").is_file())

    def test_relative_links_lead_somewhere(self):
        broken = []
        for page in pages():
            for groups in LINK.findall(prose(page)):
                link = next(group for group in groups if group)
                if re.match(r"[a-z]+:", link):
                    continue
                file, _, anchor = unquote(link).partition("#")
                target = (page.parent / file).resolve() if file else page
                if not target.exists() or SOURCE not in [target, *target.parents]:
                    broken.append(f"{page.relative_to(SOURCE)}: {link}")
                elif anchor and target.suffix == ".md" and anchor not in anchors(target):
                    broken.append(f"{page.relative_to(SOURCE)}: no heading for {link}")
        self.assertEqual(broken, [])


if __name__ == "__main__":
    unittest.main()
