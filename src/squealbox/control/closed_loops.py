"""A brake with its loops closed: poles, margins, root locus, Nyquist curve, spillover."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.arguments import public
from squealbox.control import margins, sampled
from squealbox.control.plants import Plant, plant
from squealbox.control.poles import Late, late_poles
from squealbox.extras import extra
from squealbox.parameters import ParameterError, with_cautions
from squealbox.result import COMPLETED, Array, Outcome, Result, quantity
from squealbox.system import DesignOrSystem
from squealbox.words import growing

MOST_HELD = 200.0  # samples in a delay up to which a sampling rate is looked for


@dataclass(frozen=True, kw_only=True, eq=False)
class ClosedLoop(Result):
    """The poles of a brake with loops, as :func:`closed_loop` returns them, and what follows from them.

    Without delay and sampling all poles; with a delay all to the right of `line`, `counted` of them by the argument
    principle ("poles_missed" when the two differ); of sampled loops ln(z)/h of the multipliers z of a sample h.
    """

    poles: Array = quantity("pole", "1/s", "poles, by falling growth")
    multipliers: Array = quantity("multiplier", "1", "of one sample; empty for loops that are not sampled")
    open_loop: Array = quantity("open", "1/s", "eigenvalues without the loops' forces, by falling growth")
    line: float = -np.inf
    counted: int = 0
    cautions: tuple[str, ...] = ()

    def table(self) -> dict[str, Any]:
        return {"growth rate [1/s]": self.poles.real, "frequency [Hz]": self.frequency}

    @property
    def growth_rate(self) -> float:
        """The largest growth rate [1/s]; positive grows."""
        return float(np.max(self.poles.real, initial=self.line))

    @property
    def frequency(self) -> Any:
        """|Im pole| / (2 pi) [Hz]."""
        return np.abs(self.poles.imag) / (2.0 * np.pi)

    @property
    def stable(self) -> bool:
        """True where every pole decays."""
        return bool(self.outcome.ok and self.growth_rate < 0.0)

    @property
    def plant(self) -> Plant:
        """The linear form the poles are of."""
        return plant(self.inputs["system"], self.inputs["time"])

    @property
    def gain_margin(self) -> tuple[float, float]:
        """Between which factors the gain of the loop (of the first, with the others closed) may lie."""
        return self.gain_margins[0]

    @property
    def gain_margins(self) -> tuple[tuple[float, float], ...]:
        """For each loop, the others closed, the factors its gain may lie between; NaN for an unstable brake."""
        found, of = self.plant, self._margins
        if not self.stable:
            return ((float("nan"), float("nan")),) * len(found.loops)
        return tuple(of.gain_margin(found, a) for a in range(len(found.loops)))

    @property
    def phase_margin(self) -> float:
        """The least phase [rad] by which one loop may turn, the others closed; NaN for an unstable brake."""
        found = self.plant
        if not self.stable:
            return float("nan")
        return min(self._margins.phase_margin(found, a) for a in range(len(found.loops)))

    @property
    def delay_margin(self) -> float:
        """The further delay of all loops together [s] that takes stability away; inf for none, NaN for unstable."""
        return self._margins.delay_margin(self.plant) if self.stable else float("nan")

    @property
    def _margins(self) -> Any:
        """What the margins are of: the steps between samples, or the continuous loops."""
        return sampled if len(self.multipliers) else margins

    def sampling_margin(self, computing: float = 0.0) -> float:
        """The lowest sampling rate [Hz] of all loops, held, from which on the brake is stable at every higher one.

        `computing` is the time to compute, in samples. NaN for a brake whose ideal loops do not hold it stable, inf
        where no rate does that is looked at: quicker ones are hidden by round-off, or put too many samples in a delay.
        """
        found = self.plant
        ideal = np.linalg.eigvals(found.closed)
        if not np.all(ideal.real < 0.0):
            return float("nan")

        def growth(step: float) -> float:
            values, _ = sampled.multipliers(found, 1.0 / step, found.delay + computing * step)
            return float(np.log(np.abs(values[0])) / step)

        fastest, slack = float(np.max(np.abs(ideal))), -float(np.max(ideal.real))
        low, high = 1e-4 / fastest, 1e-3 / fastest
        while growth(high) >= 0.0:
            low, high = 0.1 * low, low
            if 1e-14 / high > slack or np.max(found.delay) > MOST_HELD * high:  # ln|z| is known to some 1e-15
                return float("inf")
        while growth(high) < 0.0:
            low, high = high, (1.05 if high * fastest > 0.1 else 1.2) * high
            if high > 1e4 / fastest:
                return 0.0
        from scipy.optimize import brentq

        step: float = brentq(growth, low, high, xtol=1e-16 * high, rtol=1e-14)
        return 1.0 / step

    def root_locus(self, gains: ArrayLike, loop: int | None = None) -> Any:
        """Poles (k, ...) with the forces of one loop, or of all, times each of `gains`; delay and sampling left out."""
        found = self.plant
        factor = np.ones((len(np.atleast_1d(gains)), len(found.loops)))
        chosen = slice(None) if loop is None else loop
        factor[:, chosen] = np.reshape(np.atleast_1d(gains), (-1, 1) if loop is None else (-1,))
        values = np.linalg.eigvals(found.A + (found.B * factor[:, None, :]) @ found.H)
        return np.take_along_axis(values, np.argsort(-values.real, axis=-1), axis=-1)

    def nyquist(self, frequencies: ArrayLike, loop: int = 0) -> Any:
        """The open loop -L(i w), sampled -L(exp(i w h)), of one loop, the others closed, at frequencies [Hz].

        -1 is the critical point.
        """
        found = self.plant
        hertz = np.atleast_1d(np.asarray(frequencies, dtype=float))
        if len(self.multipliers):
            return -sampled.loop_gain(found, loop, hertz)
        return -margins.loop_gain(*margins.broken(found, loop), 2.0 * np.pi * hertz, float(found.delay[loop]))

    @property
    def spillover(self) -> Any:
        """What each loop does to each pole of the open brake, first order: w.B H u [1/s], shape (loops, open)."""
        found = self.plant
        values, right = np.linalg.eig(found.A)
        order = np.lexsort((-values.imag, -values.real))
        left = np.linalg.inv(right)
        moved = np.einsum("ia,aj->aij", left @ found.B, found.H @ right)
        return np.diagonal(moved, axis1=1, axis2=2)[:, order]

    def to_control(self) -> Any:
        """The open brake as a `control.StateSpace` (python-control), from the loops' forces to their commands.

        Delay and sampling are not in it. Needs the package `control`.
        """
        with extra("control"):
            import control

        found = self.plant
        return control.ss(found.A, found.B, found.H, np.zeros((len(found.loops), len(found.loops))))

    def summary(self) -> str:
        """Verdict, margins and poles, ready for an e-mail."""
        if not self.outcome.ok and not len(self.poles):
            return f"No poles: {self.outcome} ({self.outcome.message})"
        state = "STABLE" if self.stable else "UNSTABLE"
        lines = [f"Closed loop is {state}: largest growth rate {self.growth_rate:+.6g} 1/s"]
        if self.stable:
            low, high = self.gain_margin
            lines.append(
                f"gain between {low:.6g} and {high:.6g} times, phase margin {np.rad2deg(self.phase_margin):.6g} deg, "
                f"delay margin {self.delay_margin:.6g} s, sampling above {self.sampling_margin():.6g} Hz"
            )
        lines += [growing(s.real, s.imag / (2.0 * np.pi)) for s in self.poles if s.imag >= 0.0]
        return with_cautions(lines, *self.cautions)


@public()
def closed_loop(design_or_system: DesignOrSystem, *, line: float | None = None, time: float = 0.0) -> ClosedLoop:
    """The poles of a brake with loops about steady sliding.

    Parameters
    ----------
    design_or_system : `Controlled(brake, loops)`, any design around it, or a `System` with loops
    line : [1/s] with a delay, poles to the right of it are found; None takes -3 over the longest delay
    time : instant of schedules [s]

    Accuracy: each pole of a delayed loop solves its equation to round-off, and their number is confirmed by the
    argument principle. A limit is not felt near steady sliding; the unstable cycle `shooting` finds says how far.

    >>> from squealbox import PID, System
    >>> block = System([[1.0]], [[-0.1]], [[1.0]], loops=(PID(on="q1", derivative=0.3),))
    >>> round(closed_loop(block).delay_margin, 9)
    1.069124121
    """
    found = plant(design_or_system, time)
    inputs = {"system": design_or_system, "time": time}
    own = np.linalg.eigvals(found.A) if found.outcome.ok else np.zeros(0)
    own = own[np.lexsort((-own.imag, -own.real))].astype(complex)
    nothing = np.zeros(0, dtype=complex)
    if not found.outcome.ok:
        return ClosedLoop(poles=nothing, multipliers=nothing, open_loop=own, inputs=inputs, outcome=found.outcome)
    cautions = _cautions(found)
    if np.any(found.sampling > 0.0):
        beyond = sampled.aliased(found)
        if beyond is not None:
            rate = float(np.min(found.sampling[found.sampling > 0.0]))
            reason = f"more than twice the mode at {beyond[0]:.6g} Hz, which it takes for {beyond[1]:.6g} Hz (aliased)"
            cautions = (*cautions, f"sampling at {rate:g} Hz: expected {reason}")
        values, step = sampled.multipliers(found)
        with np.errstate(divide="ignore"):
            poles = np.log(values) / step
        outcome = Outcome(COMPLETED)
        if beyond is not None:
            outcome = Outcome("aliased", cautions[-1], rate=rate, mode=beyond[0], taken_for=beyond[1])
        poles = poles[np.isfinite(poles)]
        return ClosedLoop(
            poles=poles, multipliers=values, open_loop=own, counted=len(poles), cautions=cautions, inputs=inputs,
            outcome=outcome,
        )  # fmt: skip
    if not np.any(found.delay > 0.0):
        poles = np.linalg.eigvals(found.closed).astype(complex)
        poles = poles[np.lexsort((-poles.imag, -poles.real))]
        return ClosedLoop(
            poles=poles, multipliers=nothing, open_loop=own, counted=len(poles), cautions=cautions, inputs=inputs
        )
    at_once = found.delay == 0.0
    A = found.A + found.B[:, at_once] @ found.H[at_once]
    parts = [(float(t), np.outer(found.B[:, a], found.H[a])) for a, t in enumerate(found.delay) if t > 0.0]
    edge = -3.0 / float(np.max(found.delay)) if line is None else float(line)
    if not np.isfinite(edge):
        raise ParameterError("closed_loop", "line", line, "a finite number in 1/s")
    poles, counted = late_poles(Late(A, parts), edge)
    message = f"{len(poles)} poles found to the right of {edge:g} 1/s where the argument principle counts {counted}"
    outcome = Outcome(COMPLETED) if len(poles) == counted else Outcome("poles_missed", message, counted=counted)
    return ClosedLoop(
        poles=poles, multipliers=nothing, open_loop=own, line=edge, counted=counted, cautions=cautions, inputs=inputs,
        outcome=outcome,
    )  # fmt: skip


def _cautions(found: Plant) -> tuple[str, ...]:
    limited = [loop.on for loop in found.loops if loop.limit is not None]
    if not limited:
        return ()
    return (f"the force on {', '.join(limited)} has a limit: a push beyond it may defeat the loop",)
