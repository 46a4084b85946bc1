"""The browser of the tests: Chromium without a window, through Playwright."""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from playwright.sync_api import sync_playwright

CHROMIUM = ("chromium-headless-shell", "chromium")  # the first has no window to draw either, which takes a quarter less
FLAGS = [
    "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync",
]  # fmt: skip


@contextmanager
def launched() -> Iterator[Any]:
    """A headless Chromium with a new profile; once in a process, for a second driver beside the first is refused."""
    path = next(filter(None, map(shutil.which, CHROMIUM)), None)
    assert path, "chromium is not installed; make test installs it"
    with sync_playwright() as driver:
        running = driver.chromium.launch(executable_path=path, args=FLAGS)
        yield running
        running.close()
