"""Captures on the live page, as a person starts them: the command in a process of its own."""

import json
import os
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

START_S = 120.0
"""Until a page shows the first pictures; a machine may be busy."""
STEP_S = 60.0
"""For one step of a person."""


@dataclass
class LiveCommand:
    """``labcal capture --page`` that runs."""

    process: "subprocess.Popen[str]"
    address: str
    folder: Path
    """The shoot and the rig appear in it."""
    said: list[str] = field(default_factory=list)
    """Lines of the terminal after the address."""

    def memory_mb(self) -> float:
        """Return the resident memory, MiB."""
        status = Path(f"/proc/{self.process.pid}/status").read_text(encoding="ascii")
        found = re.search(r"VmRSS:\s+(\d+)", status)
        assert found is not None
        return int(found.group(1)) / 1024

    def interrupt(self) -> None:
        """Press Ctrl-C."""
        os.kill(self.process.pid, signal.SIGINT)

    def ended(self, timeout_s: float = STEP_S) -> dict[str, Any]:
        """Return the document of the command, which has come to its end."""
        assert self.process.stdout is not None
        self.process.wait(timeout_s)
        document: dict[str, Any] = json.loads(self.process.stdout.read())
        return document


@contextmanager
def live_command(folder: Path, words: Sequence[str]) -> Iterator[LiveCommand]:
    """Start ``labcal capture WORDS --page -o shoot --json`` in a folder, and end it after the block."""
    process = subprocess.Popen(
        [sys.executable, "-m", "labcal", "capture", *words, "--page", "-o", "shoot", "--json"],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    lines = process.stderr
    assert lines is not None
    address = next((found.group(0) for line in lines if (found := re.search(r"http\S+", line))), None)
    assert address is not None, process.wait(STEP_S)
    running = LiveCommand(process, address, folder)
    rest = threading.Thread(target=lambda: running.said.extend(lines))
    rest.start()
    try:
        yield running
    finally:
        process.terminate()
        process.wait(30)
        rest.join()
        assert process.stdout is not None
        process.stdout.close()
        lines.close()


@dataclass
class LivePage:
    """The page of a capture in a browser."""

    page: Any
    errors: list[str] = field(default_factory=list)
    """Of the console, and exceptions."""

    @property
    def views(self) -> int:
        """Views that the page counts."""
        return int(self.page.get_attribute("body", "data-views"))

    @property
    def taken(self) -> list[str]:
        """Names of the views that it lists."""
        return [one.strip() for one in self.page.locator("#taken li b").all_text_contents()]

    def until_views(self, count: int, timeout_s: float = STEP_S) -> None:
        """Wait until there are so many views."""
        self.page.wait_for_selector(f"body[data-views='{count}']", timeout=1e3 * timeout_s)

    def until_phase(self, phase: str, timeout_s: float = STEP_S) -> None:
        """Wait until the bench does something."""
        self.page.wait_for_selector(f"body[data-phase={phase}]", timeout=1e3 * timeout_s)

    def take(self) -> None:
        """Take one more view, as soon as that is possible."""
        views = self.views
        self.page.click("#take", timeout=1e3 * STEP_S)
        self.until_views(views + 1)


def live_page(context: Any, address: str) -> LivePage:  # noqa: ANN401 -- playwright may be missing
    """Open the page of a capture, and wait until a view can be taken."""
    opened = LivePage(context.new_page())
    opened.page.on("console", lambda said: said.type == "error" and opened.errors.append(said.text))
    opened.page.on("pageerror", lambda error: opened.errors.append(str(error)))
    opened.page.goto(address)
    opened.until_phase("aim", START_S)
    return opened


def until(wanted: Callable[[], bool], timeout_s: float = STEP_S) -> None:
    """Wait until something is true."""
    end = time.monotonic() + timeout_s
    while not wanted():
        assert time.monotonic() < end
        time.sleep(0.05)
