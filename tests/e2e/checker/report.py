"""What was checked, one line each."""


class Report:
    """Collects checks. A check holds or fails; a note is a figure that nothing was promised about."""

    def __init__(self):
        self.rows = []

    def check(self, name, holds, figures=""):
        """Records one promise; returns whether it holds."""
        self.rows.append({"check": name, "result": "ok" if holds else "FAIL", "figures": str(figures)})
        return bool(holds)

    def note(self, name, figures):
        self.rows.append({"check": name, "result": "note", "figures": str(figures)})

    def skip(self, name, reason):
        self.rows.append({"check": name, "result": "skip", "figures": reason})

    def failures(self):
        return [row for row in self.rows if row["result"] == "FAIL"]

    def lines(self):
        return [f"{row['result']:<5}{row['check']}" + (f": {row['figures']}" if row["figures"] else "")
                for row in self.rows]


def first_few(items, count=4):
    """'a, b, c and 7 more'"""
    items = [str(item) for item in items]
    if len(items) <= count:
        return ", ".join(items)
    return ", ".join(items[:count]) + f" and {len(items) - count} more"
