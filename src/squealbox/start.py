"""Where a motion begins: every spelling of a start, read in one place.

    None, "rest"                      q = q' = 0: the loads are applied suddenly
    "sliding"                         steady sliding without vibration
    "mode", "mode 2"                  steady sliding with a vibration in the mode that grows fastest, or in the second
    {"mode": 2, "amplitude": 1e-6}    the same, by how much [m], as `Mode.start` measures it
    a `Mode`                          that mode
    (q, qd), (q, qd, z)               displacements [m], velocities [m/s], deflections [m] of laws with memory
    a `Trajectory`, a `Cycle`         where the motion ended, where the period begins

Modes are counted from 1, as tables and figures count them. Where nobody says how much, the sliding speed of a contact
swings by `SHARE` of it: small enough for the linear theory. Depends on: parameters, schedules, stability, system.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike

from squealbox.parameters import ParameterError
from squealbox.schedules import value_at
from squealbox.system import DesignOrSystem, InvalidSystem, System, equilibrium

SHARE = 0.01  # of the sliding speed
NO_SLIDING = "there is no steady sliding to start from"
SMALL = 1e-6  # m, where no contact slides
WORDS = '"rest" or "sliding", "mode 1" or {"mode": 1, "amplitude": 1e-6}, a Mode, a Trajectory or a Cycle'


class WithStart(Protocol):
    """A mode or a cycle: it has a state where it begins."""

    @property
    def start(self) -> Any:
        """The state, or what makes it of an amplitude."""


class WithEnd(Protocol):
    """A trajectory: it has a state where it ended."""

    @property
    def end(self) -> Any:
        """The state."""


StartLike = str | Mapping[str, Any] | Sequence[ArrayLike] | WithStart | WithEnd | None  # the spellings above


@dataclass(frozen=True, eq=False)
class Start:
    """q and q' (..., n) at the beginning; z the deflections of laws with memory, None for straight bristles.

    sliding is True for steady sliding, in which such laws are bent.
    """

    q: Any
    qd: Any
    z: Any = None
    sliding: bool = False

    @classmethod
    def of(
        cls, owner: str, start: Any, system: System, time: float = 0.0, *, modes_of: DesignOrSystem | None = None,
        members: tuple[tuple[int, ...], slice] | None = None, rows: int | None = None, name: str = "start",
        share: float = SHARE,
    ) -> "Start":  # fmt: skip
        """The start that any of the spellings above means for a system.

        Parameters
        ----------
        owner, name : the function that was asked and its argument, for errors
        time : [s], of schedules
        modes_of : the design or system whose modes are counted; None takes the system itself
        members : shape of an ensemble whose states may have leading axes, and the part of it that `system` stands for
        rows : how many rows of the system are the brake's; the others begin at zero where they are not given
        share : of the sliding speed by which a mode without an amplitude makes it swing

        Raises `ParameterError` for what is no start, `InvalidSystem` where there is no steady sliding.
        """
        n = system.size
        own = n if rows is None else rows
        if start is None or (isinstance(start, str) and start == "rest"):
            return cls(np.zeros(n), np.zeros(n))
        if isinstance(start, str) and start == "sliding":
            return cls(sliding(system, time), np.zeros(n), sliding=True)
        count = sum(contact.law.has_memory for contact in system.contacts)
        many = f"with {own} values each" if members is None else f"of shape (..., {own})"
        expected = f"(q, qd) {many}, {WORDS}"
        asked = in_words(start)
        if callable(getattr(start, "start", None)):
            value, shape = start.eigenvalue, _padded(start.shape[:own], n)
            size = visible(system, value, shape, share)
            return cls(*beside(_padded(start.steady[:own], n), value, shape, size))
        if asked is not None:
            value, shape, steady = _in_mode(owner, name, asked, system if modes_of is None else modes_of, time)
            shape, steady = _padded(shape[..., :own], n), _padded(steady[..., :own], n)
            amplitude = asked.get("amplitude")
            if amplitude is None:
                amplitude = visible(system, value, shape, share)
            elif not (np.ndim(amplitude) == 0 and np.isreal(amplitude) and 0.0 < amplitude < np.inf):
                raise ParameterError(owner, name, asked, "an amplitude above 0 m")
            return cls(*beside(steady, value, shape, amplitude))
        start = getattr(start, "end", getattr(start, "start", start))
        try:
            if isinstance(start, (str, Mapping)) or len(start) not in (2, 3):
                raise TypeError
            q, qd, *z = (np.asarray(part, dtype=float) for part in start)
            if members is None:
                q, qd = (_padded(x.reshape(own if x.size == own else n), n) for x in (q, qd))
            else:
                q, qd, *z = _of_members([q, qd, *z], (n, n, count), system.shape, *members)
        except (TypeError, ValueError) as error:
            raise ParameterError(owner, name, start, expected) from error
        if z and (count == 0 or z[0].shape[-1:] != (count,) or not np.all(np.isfinite(z[0]))):
            told = f"(q, qd, z) with {count} deflections, one for each contact with memory" if count else "(q, qd)"
            raise ParameterError(owner, name, start, told)
        if not (np.all(np.isfinite(q)) and np.all(np.isfinite(qd))):
            raise ParameterError(owner, name, start, "finite displacements and velocities")
        return cls(np.array(q), np.array(qd), z[0] if z else None)

    @property
    def state(self) -> Any:
        """q and q' in one row, shape (..., 2n)."""
        return np.concatenate(np.broadcast_arrays(self.q, self.qd), axis=-1)


def sliding(system: System, time: float = 0.0) -> Any:
    """Steady sliding q (..., n) at `time` [s]; `InvalidSystem` where there is none."""
    state = equilibrium(system, time)
    if not np.all(state.exists):
        raise InvalidSystem(f"{NO_SLIDING}: {state.outcome.message}")
    return state.q


def in_words(start: StartLike) -> dict[str, Any] | None:
    """A start in a mode, "mode 2" or {"mode": 2, "amplitude": ...}, as the latter; None for any other."""
    if isinstance(start, str):
        word, _, number = start.strip().partition(" ")
        if word == "mode" and (not number or number.strip().isdigit()):
            return {"mode": int(number) if number else None}
        return None
    return dict(start) if isinstance(start, Mapping) and set(start) - {"amplitude"} == {"mode"} else None


def beside(steady: np.ndarray, eigenvalue: ArrayLike, shape: np.ndarray, amplitude: ArrayLike) -> tuple[Any, Any]:
    """q and q' (..., n) of steady sliding with a mode of that amplitude [m], |u| = 1."""
    turned = np.asarray(amplitude)[..., None] * shape
    return steady + turned.real, (np.asarray(eigenvalue)[..., None] * turned).real


def visible(system: System, eigenvalue: ArrayLike, shape: np.ndarray, share: float = SHARE) -> Any:
    """Amplitude [m] of a mode (..., n) at which the sliding speed of some contact swings by a share of it."""
    found: Any = np.inf
    for contact in system.contacts:
        speed = np.abs(np.asarray(value_at(contact.V, 0.0), dtype=float))
        swing = np.abs(np.sum(contact.t * (np.asarray(eigenvalue)[..., None] * shape), axis=-1))
        slides = (speed > 0.0) & (swing > 0.0)
        found = np.minimum(found, np.where(slides, speed / np.where(slides, swing, 1.0), np.inf))
    return np.where(np.isfinite(found), share * found, SMALL)


def _in_mode(
    owner: str, name: str, asked: Mapping[str, Any], design: DesignOrSystem, time: float
) -> tuple[Any, Any, Any]:
    """Eigenvalue (...), shape and steady sliding (..., rows) of the mode asked for."""
    from squealbox.stability import complex_modes

    modes = complex_modes(design, time)
    if not np.all(modes.exists):
        raise InvalidSystem(f"{NO_SLIDING}: {modes.outcome.message}")
    half, number = modes.eigenvalues.shape[-1] // 2, asked["mode"]
    values = modes.eigenvalues[..., :half]
    if number is None:  # rigid-body motion neither grows nor dies
        rigid = (values == 0.0) & (np.asarray(modes.floating)[..., None] > 0)
        index = np.argmax(np.where(np.isfinite(values) & ~rigid, values.real, -np.inf), axis=-1)
    elif isinstance(number, (int, np.integer)) and not isinstance(number, bool) and 1 <= number <= half:
        index = np.full(values.shape[:-1], number - 1)
    else:
        raise ParameterError(owner, name, dict(asked), f"a mode from 1 to {half}")
    value = np.take_along_axis(values, index[..., None], axis=-1)[..., 0]
    if not np.all(np.isfinite(value)):
        raise ParameterError(owner, name, dict(asked), "a mode with a finite eigenvalue")
    return value, np.take_along_axis(modes.right, index[..., None, None], axis=-1)[..., 0], modes.steady


def _padded(x: np.ndarray, size: int) -> Any:
    """States (..., k) with zeros behind them, (..., size)."""
    return np.concatenate([x, np.zeros((*x.shape[:-1], size - x.shape[-1]))], axis=-1)


def _of_members(
    parts: list[Any], widths: tuple[int, ...], batch: tuple[int, ...], shape: tuple[int, ...], part: slice
) -> list[Any]:
    """Each of the states (..., width) for a part of an ensemble; those without leading axes serve all."""
    if any(x.shape[-1:] != (width,) for x, width in zip(parts, widths, strict=False)):
        raise ValueError("states of another length")
    if all(x.ndim == 1 for x in parts):
        return parts
    own = batch or (part.stop - part.start,)
    found = []
    for x, width in zip(parts, widths, strict=False):
        found.append(np.broadcast_to(x, (*shape, width)).reshape(-1, width)[part].reshape(*own, width))
    return found
