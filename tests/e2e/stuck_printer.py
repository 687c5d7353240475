"""A printer that stops listening in the middle of a print, for tests of what is done about it."""
import os
import pty
import select
import termios
import threading
import tty


class StuckPrinter:
    """Behind a pseudo-terminal: says ok to every line, until it is told to wait for the bed."""

    def __init__(self, test):
        self.master, self.slave = pty.openpty()
        tty.setraw(self.slave, termios.TCSANOW)
        self.name, self.heard, self.ends = os.ttyname(self.slave), b"", False
        self.thread = threading.Thread(target=self.answer, daemon=True)
        self.thread.start()
        test.addCleanup(self.close)

    def answer(self):
        rest = b""
        while not self.ends:
            if not select.select([self.master], [], [], 0.05)[0]:
                continue
            *lines, rest = (rest + os.read(self.master, 4096)).split(b"\n")
            for line in lines:
                self.heard += line + b"\n"
                if line and b"M190" not in self.heard:
                    os.write(self.master, b"FIRMWARE_NAME:Stuck\nok\n" if line == b"M115" else b"ok\n")

    def close(self):
        self.ends = True
        self.thread.join()
        os.close(self.master)
        os.close(self.slave)
