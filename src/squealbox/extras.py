"""Libraries that come with an extra: where one is missing, the sentence with the command that installs it."""

import importlib.util
from collections.abc import Iterator
from contextlib import contextmanager


class MissingExtra(ModuleNotFoundError):
    """A library that is not installed; the message names the extra it comes with, and the command."""

    def __init__(self, library: str, extra: str) -> None:
        text = f"{library} is missing: it comes with the extra {extra}, pip install 'squealbox[{extra}]'"
        super().__init__(text, name=library)


@contextmanager
def extra(name: str) -> Iterator[None]:
    """Imports of what the extra of that name brings; `MissingExtra` where it is not installed.

    >>> with extra("fe"):
    ...     import nothing_here
    Traceback (most recent call last):
    squealbox.extras.MissingExtra: nothing_here is missing: it comes with the extra fe, pip install 'squealbox[fe]'
    """
    try:
        yield
    except ModuleNotFoundError as error:
        library = str(error.name).partition(".")[0]
        if library in ("squealbox", "None"):
            raise  # a mistake of the program's own
        raise MissingExtra(library, name) from error


def need(name: str, *libraries: str) -> None:
    """Raise `MissingExtra` for the first of the libraries of that extra that is not installed; imports none."""
    for library in libraries:
        if importlib.util.find_spec(library) is None:
            raise MissingExtra(library, name)
