"""What was made of the latest frozen objects, told apart by identity: asking again costs no comparison of arrays."""

import threading
from collections.abc import Callable
from typing import Any


class Latest:
    """Keeps `most` answers and the objects they belong to."""

    def __init__(self, most: int = 64) -> None:
        self.most = most
        self.kept: dict[Any, tuple[Any, Any]] = {}
        self.lock = threading.Lock()

    def of(self, thing: Any, how: Any, make: Callable[[], Any]) -> Any:
        """The answer for a thing and how it was asked, made at the first time."""
        key = id(thing), how
        found = self.kept.get(key) or (thing, make())
        with self.lock:  # threads of a page ask at once
            self.kept.pop(key, None)
            self.kept[key] = found
            if len(self.kept) > self.most:
                self.kept.pop(next(iter(self.kept)))
        return found[1]

    def clear(self) -> None:
        """Forget all."""
        self.kept.clear()
