"""What drives browsers: once in a process at a time, for a second driver beside the first is refused."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from playwright.sync_api import sync_playwright

OPEN: list[Any] = []


@contextmanager
def driven() -> Iterator[Any]:
    """The driver that is open, or one that is closed afterwards."""
    if OPEN:
        yield OPEN[0]
        return
    with sync_playwright() as driver:
        OPEN.append(driver)
        try:
            yield driver
        finally:
            OPEN.clear()
