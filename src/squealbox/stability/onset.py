"""At which values of a parameter does steady sliding lose, or regain, its stability, and by which mechanism?"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from squealbox.arguments import public
from squealbox.family import Bounds, DesignOrRecipe, Varied
from squealbox.result import Array, Outcome, Result, quantity
from squealbox.stability.crossing_in_band import crossings_between
from squealbox.stability.deflation import vibrating
from squealbox.stability.eigenvalues import ComplexModes, OneEigenvalue, modes_of
from squealbox.stability.family import Steady, SteadyFamily, entry
from squealbox.stability.in_band import POINTS as POINTS_IN_BAND
from squealbox.stability.mechanisms import Mechanism, mechanism_at
from squealbox.stability.polishing import Polished, polished
from squealbox.stability.scan import Scan, merging, scan
from squealbox.stability.state_matrix import spectrum

POINTS = 401  # values of a scan
ASIDE = 1e-13  # share of the range by which a singular point is stepped aside
POINT = 1e-9  # share of the range up to which a stretch without an answer is a single value
SPLIT = 1e-4  # share of the largest |lambda|: a mode that grows or decays by more does not cross
FUNCTION = 1e-12  # round-off of a scanned function, as a share of its scale
ROUND_OFF = 1e-14  # share of |lambda| below which a term of the growth rate is none
ALIKE = 1e-10  # share of the largest |lambda| by which growth rates differ at a root that is known to some digits less
BESIDE = 1e-6  # share of the range by which the mechanism of a neutral system is looked at beyond its onset


@dataclass(frozen=True, kw_only=True, eq=False)
class CriticalValue(OneEigenvalue, Result):
    """One value of a parameter at which a mode crosses zero growth, as :func:`critical_value` returns it.

    direction is "destabilising" (the mode grows above) or "stabilising" (it grows below); mechanism is flutter,
    negative_slope, divergence or mixed, with base, circulation and slope [1/s] the terms behind the name. uncertainty
    bounds the error of the value by round-off, in its unit (`stability.polishing`).
    """

    value: Any = quantity("", "", "critical value of the parameter, in its own unit; NaN when there is none")
    eigenvalue: Any = quantity("", "1/s", "eigenvalue on the boundary")
    shape: Array = quantity("dof", "1", "mode that crosses, |u| = 1")
    parameter: str = ""
    direction: str = ""
    mechanism: str = ""
    base: float = float("nan")
    circulation: float = float("nan")
    slope: float = float("nan")
    unstable_below: int = 0
    unstable_above: int = 0
    uncertainty: float = float("nan")

    swept: ClassVar = {
        "value": ("", "", "critical value of the parameter, in its own unit"),
        "frequency": ("", "Hz", "frequency of the mode that crosses"),
        "mechanism": ("", "", "flutter, negative_slope, divergence or mixed"),
        "direction": ("", "", "destabilising or stabilising"),
    }

    @property
    def changes_stability(self) -> bool:
        """True when the system as a whole is stable on one side and unstable on the other."""
        return (self.unstable_below == 0) != (self.unstable_above == 0)

    @property
    def shares(self) -> dict[str, float]:
        """Shares of the two parts of friction in what feeds the mode, each 0 to 1."""
        why = Mechanism(self.mechanism, self.base, self.circulation, self.slope)
        return {"flutter": why.flutter_share, "negative_slope": why.negative_slope_share}

    def summary(self) -> str:
        """One line: the value, where it leads, the frequency and the mechanism with its shares."""
        return self.told()

    def told(self, digits: int = 10) -> str:
        """The `summary`, with so many digits [-] of the value."""
        if not self.outcome.ok:
            return f"{self.parameter}: {self.outcome.told}"
        why = Mechanism(self.mechanism, self.base, self.circulation, self.slope)
        aside = f"; {self.outcome.message}" if self.outcome.message else ""
        first = "squeal begins" if self.changes_stability else "one more mode"
        side = "above" if self.direction == "destabilising" else "below"
        place = f"{self.parameter} = {self.read_value(self.parameter, self.value, digits)}"
        return f"{place}: {first}; {side} it a mode of {self.frequency:.6g} Hz grows, mechanism {why}{aside}"


@dataclass(frozen=True, kw_only=True, eq=False)
class CriticalValues(Result):
    """All crossings in a range, in rising order; iterate for :class:`CriticalValue`, or use the arrays as a table."""

    value: Array = quantity("crossing", "", "critical values of the parameter, in its own unit")
    eigenvalue: Array = quantity("crossing", "1/s", "eigenvalue on the boundary")
    shape: Array = quantity("crossing dof", "1", "mode that crosses, |u| = 1")
    direction: Array = quantity("crossing", "1", "destabilising or stabilising")
    mechanism: Array = quantity("crossing", "1", "flutter, negative_slope, divergence or mixed")
    base: Array = quantity("crossing", "1/s", "growth rate without what feeds it")
    circulation: Array = quantity("crossing", "1/s", "brought by circulatory forces")
    slope: Array = quantity("crossing", "1/s", "brought by the damping part of friction")
    unstable_below: Array = quantity("crossing", "1", "unstable modes just below")
    unstable_above: Array = quantity("crossing", "1", "unstable modes just above")
    uncertainty: Array = quantity("crossing", "", "bound on the error of the value, in the parameter's own unit")
    parameter: str = ""

    @property
    def changes(self) -> list[CriticalValue]:
        """Those at which the stability of the system as a whole changes, in rising order."""
        return [each for each in self if each.changes_stability]

    def nearest(self, value: float) -> CriticalValue | None:
        """The change of stability nearest to a value [own unit of the parameter]; None where there is none.

        >>> from squealbox import DrumBrake, critical_values
        >>> round(float(critical_values(DrumBrake(), "friction.static", (0.0, 1.0)).nearest(0.3).value), 5)
        0.33269
        """
        return min(self.changes, key=lambda each: abs(float(each.value) - value), default=None)

    def __len__(self) -> int:
        return len(self.value)

    def __iter__(self) -> Iterator[CriticalValue]:
        names = ("value", "eigenvalue", "shape", "base", "circulation", "slope", "unstable_below", "unstable_above",
                 "uncertainty")  # fmt: skip
        for i in range(len(self)):
            arrays = {name: getattr(self, name)[i] for name in names}
            labels: dict[str, Any] = {name: str(getattr(self, name)[i]) for name in ("direction", "mechanism")}
            about: dict[str, Any] = {
                "parameter": self.parameter,
                "inputs": self.inputs,
                "settings": self.settings,
                "outcome": self.outcome,
            }
            yield CriticalValue(**arrays, **labels, **about)

    def summary(self) -> str:
        """A line for each crossing, ready for an e-mail."""
        if len(self) == 0:
            return f"{self.parameter}: {self.outcome.told}"
        return "\n".join(crossing.summary() for crossing in self)


@public()
def critical_value(
    design: DesignOrRecipe,
    parameter: Varied,
    bounds: Bounds | None = None,
    *,
    points: int | None = None,
    time: float = 0.0,
) -> CriticalValue:
    """The first value from below, between `bounds`, at which steady sliding changes its stability.

    Parameters
    ----------
    design : a design whose ``replace({parameter: values})`` makes a batch, or a function of one value that returns a
        design or a system
    parameter, bounds : {name: (low, high)} in the parameter's own unit, such as {"friction.static": (0, 1)}; or the
        name and the bounds one after the other. Of a function the name is what the result calls its argument
    points : number of values scanned before narrow windows are looked for; None takes 401, of a reduced brake 81
    time : instant of schedules [s]

    Of a reduced brake only modes in its band count: above it, it has modes that are none of the full brake. The value
    is that of the full brake as far as the estimate of the eigenvalue's error there says, and `uncertainty` is what
    this estimate makes of it.

    Returns a `CriticalValue`, good to its `uncertainty`: 1e-13 of the value, more where the growth rate hardly
    changes with the parameter. Without a change the outcome is "no_onset", with the growth rates
    at both ends as evidence; "hidden_onset" when it lies in a stretch without steady sliding;
    "no_equilibrium" when steady sliding exists nowhere in the range. Bad bounds are a
    `ParameterError`.

    >>> from squealbox import DrumBrake, critical_value
    >>> round(float(critical_value(DrumBrake(), {"friction.static": (0.0, 1.0)}).value), 5)
    0.33269
    """
    family = SteadyFamily.within("critical_value", design, parameter, bounds, time=time)
    every = _crossings(family, points, first=True)
    if not every.outcome.ok:
        nothing: dict[str, Any] = {"value": np.nan, "eigenvalue": complex(np.nan), "shape": np.array([])}
        about: dict[str, Any] = {"inputs": every.inputs, "settings": every.settings, "outcome": every.outcome}
        return CriticalValue(**nothing, **about, parameter=family.name)
    return next(iter(every))


@public()
def critical_values(
    design: DesignOrRecipe,
    parameter: Varied,
    bounds: Bounds | None = None,
    *,
    points: int | None = None,
    time: float = 0.0,
) -> CriticalValues:
    """Every value between `bounds` [SI] at which any mode crosses zero growth; arguments as for :func:`critical_value`.

    `time` [s]: instant at which schedules are taken.

    For a system without damping only changes of the stability of the whole are seen: its modes merge, none crosses.
    """
    return _crossings(SteadyFamily.within("critical_values", design, parameter, bounds, time=time), points, first=False)


def _crossings(family: SteadyFamily, points: int | None, *, first: bool) -> CriticalValues:
    points = (POINTS if family.band is None else POINTS_IN_BAND) if points is None else points
    if points < 3:
        raise ValueError(f"points = {points}: expected at least 3")
    low, high = family.spans[0]
    found = scan(family, low, high, points)
    rows, hidden = [], [(i, j) for i, j, k in found.jumps() if k == 0 or not first]
    band = family.band
    brackets = found.brackets() if band is None else iter(())
    for i, k in brackets:
        if first and k > 0:
            continue
        row = _crossing(found, i, k, high - low)
        if not found.neutral and abs(row["eigenvalue"].real) > SPLIT * row["fastest"]:
            continue  # a growing pair became two real eigenvalues: one mode more grows, and none crossed
        rows.append(row)
        if first:
            break
    if band is not None:
        rows = _rows_in_band(found, first)
    wide = []
    for i, j in hidden:
        a, b = float(found.values[i]), float(found.values[j])
        if b - a <= POINT * (high - low):  # a single value without an answer, at which the growth rate jumps
            if not (first and rows and rows[0]["value"] < a):
                rows = [_jump(found, i, j)] if first else [*rows, _jump(found, i, j)]
                if first:
                    break
        else:
            wide.append([a, b])
    rows.sort(key=lambda row: row["value"])
    evidence = {"without_answer": [list(gap) for gap in found.gaps]} if found.gaps else {}
    if wide and not (rows and rows[0]["value"] < wide[0][0]):
        said = f"stability changes between {wide[0][0]:.10g} and {wide[0][1]:.10g}, where there is no steady sliding"
        outcome = Outcome("hidden_onset", said, **evidence)
        rows = [] if first else rows
    else:
        outcome = Outcome("completed", _gaps(found), **evidence) if rows else _no_onset(family, found, low, high)
    size = rows[0]["shape"].size if rows else 0
    empty = {"value": 0.0, "eigenvalue": 0j, "shape": np.zeros(size), "direction": "", "mechanism": "", "base": 0.0}
    empty |= {"circulation": 0.0, "slope": 0.0, "unstable_below": 0, "unstable_above": 0, "uncertainty": 0.0}
    columns: dict[str, Any] = {
        name: np.array([row[name] for row in rows]) if rows else np.array([like])[:0] for name, like in empty.items()
    }
    settings = {"bounds": [low, high], "points": points}
    return CriticalValues(
        **columns, parameter=family.parameters[0], inputs=family.inputs, settings=settings, outcome=outcome
    )


def _rows_in_band(found: Scan, first: bool) -> list[dict[str, Any]]:
    """The crossings of a reduced brake; a growing mode that only comes into its band, or leaves it, is none."""
    rows: list[dict[str, Any]] = []
    for i in sorted({i for i, _ in found.brackets()}):
        rows += crossings_between(found, i)
        changes = [row for row in rows if 0 in (row["unstable_below"], row["unstable_above"])]
        if first and changes:
            return changes[:1]
    return [] if first else rows


def _gaps(found: Scan) -> str:
    """Where in the range there was no answer, in words."""
    spans = [f"{a:.6g}" if a == b else f"{a:.6g} to {b:.6g}" for a, b in found.gaps]
    more = f" and {len(spans) - 3} more stretches" if len(spans) > 3 else ""
    return f"there is no steady sliding at {', '.join(spans[:3])}{more}" if spans else ""


def _jump(found: Scan, i: int, j: int) -> dict[str, Any]:
    """The crossing of the first function at a single value without an answer, seen from its unstable side."""
    rising = bool(found.functions[j, 0] > 0.0)
    value = float(0.5 * (found.values[i] + found.values[j]))
    return _described(found, value, float(found.values[j if rising else i]), 0, rising, i, 0.0)


def _crossing(found: Scan, i: int, k: int, width: float) -> dict[str, Any]:
    value = found.root(i, k)
    rising = bool(found.functions[i + 1, k] > 0.0)
    return _described(found, value, value, k, rising, i, width)


def _beside(found: Scan, value: float) -> tuple[Steady, ComplexModes] | None:
    """Steady sliding at a value and its modes, None where there is none."""
    steady = found.family.at(np.array([value]))
    return (steady, modes_of(steady)) if steady.equilibrium.exists[0] else None


def _growing(modes: ComplexModes, undamped: int) -> Any:
    """Growth rate [1/s] of each mode, conjugates counted once; -inf of common motions of bodies, NaN stays."""
    half = modes.eigenvalues.shape[-1] // 2
    resting = modes.eigenvalues[0, :half] == 0.0
    return np.where(resting & (np.cumsum(resting) <= undamped), -np.inf, modes.growth_rate[0, :half])


def _nearest(modes: ComplexModes, eigenvalue: complex) -> int:
    """Which mode, conjugates counted once, is nearest to an eigenvalue [1/s]."""
    half = modes.eigenvalues.shape[-1] // 2
    return int(np.argmin(np.abs(modes.eigenvalues[0, :half] - eigenvalue)))


def _rank(modes: ComplexModes, place: int, undamped: int) -> int:
    """How many modes grow faster than one of them."""
    return int(np.sum(_growing(modes, undamped) > modes.growth_rate[0, place]))


def _described(found: Scan, value: float, beside: float, k: int, rising: bool, i: int, width: float) -> dict[str, Any]:
    """What crosses at `value`, from the modes at `beside`."""
    place_of = beside
    steady = found.family.at(np.array([place_of]))
    for share in (ASIDE, -ASIDE, 1e3 * ASIDE, -1e3 * ASIDE):
        if steady.equilibrium.exists[0]:
            break
        steady = found.family.at(np.array([value + share * width]))  # K_eff is singular at the root itself
    modes = modes_of(steady)
    beyond = value + (BESIDE if rising else -BESIDE) * width
    if found.neutral:
        eigenvalue = merging(modes.eigenvalues[0])
        place = _nearest(modes, eigenvalue)
        why = mechanism_at(entry(found.family.at(np.array([beyond])), (0,)), eigenvalue.imag)
        counts = (int(found.functions[i, 0] > 0.0), int(rising))
    else:
        here = found.at(place_of)[k] if found.family.band else found.functions_of(steady)[0, k]
        growth = _growing(modes, found.undamped)
        off = np.where(np.isfinite(growth), np.abs(growth - (0.0 if np.isnan(here) else here)), np.inf)
        place = int(np.argmin(off))
        alike = np.flatnonzero(off <= ALIKE * np.nanmax(np.abs(modes.eigenvalues[0]), initial=0.0))
        if len(alike) > 1 and (there := _beside(found, beyond)):
            # several cross at once, or some stay undamped: it is the one that grows as the k-th where it is unstable
            ranked = np.argsort(-_growing(there[1], found.undamped), kind="stable")
            one = there[1].eigenvalues[0, ranked[k]]
            place = int(alike[np.argmin(np.abs(modes.eigenvalues[0, alike] - one))])
        eigenvalue = complex(modes.eigenvalues[0, place])
        why = mechanism_at(entry(steady, (0,)), eigenvalue.imag, rank=_rank(modes, place, found.undamped))
        feeds_beyond = max(why.circulation, why.slope) <= ROUND_OFF * abs(eigenvalue)
        if feeds_beyond and (there := _beside(found, beyond)):
            rank = _rank(there[1], _nearest(there[1], eigenvalue), found.undamped)
            why = mechanism_at(entry(there[0], (0,)), eigenvalue.imag, rank=rank)
        counts = (k, k + 1) if rising else (k + 1, k)
    exact = _exact(found, value, beside, eigenvalue, k, i)
    return {
        "value": exact.value,
        "uncertainty": exact.uncertainty,
        "eigenvalue": exact.eigenvalue,
        "shape": modes.right[0, :, place],
        "direction": "destabilising" if rising else "stabilising",
        "mechanism": why.name,
        "base": why.base,
        "circulation": why.circulation,
        "slope": why.slope,
        "fastest": float(np.nanmax(np.abs(modes.eigenvalues[0]), initial=0.0)),
        "unstable_below": counts[0],
        "unstable_above": counts[1],
    }


def _exact(found: Scan, value: float, beside: float, eigenvalue: complex, k: int, i: int) -> Polished:
    """The crossing polished, with its bound; where it is no simple eigenvalue, a bound from the scanned function."""
    low, high = float(found.values[i]), float(found.values[min(i + 1, len(found.values) - 1)])
    if beside != value:  # a jump at a single value without an answer: known to lie between its neighbours
        return Polished(value, eigenvalue, abs(beside - value))
    if not found.neutral:
        exact = polished(found.family, value, eigenvalue, low, high)
        if np.isfinite(exact.uncertainty):
            return exact
    ends = found.functions[i, k], found.functions[min(i + 1, len(found.values) - 1), k]
    step = 1e-3 * (high - low)
    near = [found.at(x)[k] for x in (value - step, value + step)]
    slope = min(abs(near[1] - near[0]) / (2.0 * step), abs(ends[1] - ends[0]) / (high - low) if high > low else np.inf)
    noise = FUNCTION if found.neutral else FUNCTION * max(abs(eigenvalue), 1e-300)
    root_finder = 1e-12 * max(abs(low), abs(high))
    return Polished(value, eigenvalue, noise / slope + root_finder if slope > 0.0 else high - low)


def _no_onset(family: SteadyFamily, found: Scan, low: float, high: float) -> Outcome:
    ends = family.at(np.array([low, high]))
    known = np.isfinite(found.functions)
    if not np.any(known):
        return Outcome("no_equilibrium", f"no steady sliding in the range: {ends.equilibrium.outcome.message}")
    if family.band is None:
        growth = [float(g) for g in vibrating(spectrum(ends), ends.equilibrium.floating)]
    else:
        growth = [float(g) for g in found.functions[[0, -1], 0]]
    state = "unstable" if np.any(found.functions[known] > 0.0) else "stable"
    where = f"{state} wherever there is steady sliding; {_gaps(found)}" if found.gaps else f"{state} in the whole range"
    evidence: dict[str, Any] = {"without_answer": [list(gap) for gap in found.gaps]} if found.gaps else {}
    return Outcome("no_onset", where, growth_rate_low=growth[0], growth_rate_high=growth[1], **evidence)
