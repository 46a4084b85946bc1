"""A brake under control: loops that sense it and act on it."""

from collections.abc import Mapping
from typing import Any, ClassVar, Self

from squealbox.countermeasures.base import Countermeasure
from squealbox.declarations import UNSAID
from squealbox.loops import Loop, check_loops
from squealbox.parameters import ParameterError
from squealbox.system import System


class Controlled(Countermeasure):
    """The brake with loops. `loops` is one loop or several; "loops.0.derivative" names a parameter of the first.

    >>> from squealbox import PID, ModeCoupling, Coulomb, complex_modes
    >>> brake = Controlled(ModeCoupling(friction=Coulomb(0.9), c1=0.02), [PID(on="y", derivative=0.1)])
    >>> complex_modes(brake).outcome
    'completed'
    """

    title: ClassVar[str] = "Controlled brake"
    source: ClassVar[str] = "Hewit and Burdess 1981; Hashemi-Dehkordi, Mailah and Abu-Bakar 2009"

    loops: tuple[Loop, ...] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.loops:
            raise ParameterError("Controlled", "loops", self.loops, "one loop or more, such as PID(on='y')")
        try:
            kept = check_loops(self.loops, self.brake.system().names, ValueError)
        except ParameterError:
            raise
        except ValueError as error:
            raise ParameterError("Controlled", "loops", self.loops, str(error)) from error
        object.__setattr__(self, "loops", kept)

    def system(self) -> System:
        """The brake's equation with the loops."""
        base = self.brake.system()
        return base.replace(loops=(*base.loops, *self.loops))

    def replace(self, changes: Mapping[str, Any] | None = None, **keywords: Any) -> Self:
        """A copy with other values; "loops.0.derivative" reaches into the first loop."""
        others, loops = {}, list(self.loops)
        for name, value in {**(changes or {}), **keywords}.items():
            if name.startswith("loops."):
                at, inner = self._loop(name)
                loops[at] = loops[at].replace({inner: value})
            else:
                others[name] = value
        if len(others) < len({**(changes or {}), **keywords}):
            others["loops"] = tuple(loops)
        return super().replace(others)

    def value_of(self, path: str) -> Any:
        """The value behind a dotted name."""
        if path.startswith("loops."):
            at, inner = self._loop(path)
            return self.loops[at].value_of(inner)
        return super().value_of(path)

    def leaves(self, prefix: str = "") -> Any:
        """Every declared parameter, the loops' included."""
        yield from super().leaves(prefix)
        for i, loop in enumerate(self.loops):
            yield from loop.leaves(f"{prefix}loops.{i}.")

    def _loop(self, path: str) -> tuple[int, str]:
        place, _, inner = path.removeprefix("loops.").partition(".")
        if not place.isdigit() or int(place) >= len(self.loops) or not inner:
            raise ParameterError("Controlled", path, UNSAID, f"loops.0.NAME to loops.{len(self.loops) - 1}.NAME")
        return int(place), inner
