"""Figures of a motion: time history, phase plane, energy audit, and all of them together."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.matrices import liveliest
from squealbox.plots.dispatch import drawn_by
from squealbox.plots.key_numbers import read_of
from squealbox.plots.spectra import spectrum
from squealbox.plots.style import drawing, figure_of, line, note, panels, uncertain
from squealbox.signals import LEAST, MotionLike, SignalError, column, equal_steps, values
from squealbox.transient import Trajectory, Verdict, resolved, smooth_curve, verdict
from squealbox.words import number, quantity_label, scaled, unit_at

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from squealbox.plots.style import Panels

SMOOTH = 20  # points of a drawn curve between two turning points
LARGEST, STRETCHES = 20_000, 40  # points of a line, beyond which more only blacken it; parts of it that are then drawn
MANY, LAST = 25.0, 6.0  # periods from which a history is a black block, and those of its end that are drawn apart


def time_history(
    motion: MotionLike,
    t: ArrayLike | None = None,
    *,
    dof: Any = 0,
    verdict: Verdict | None = None,
    name: str = "displacement",
    unit: str | None = None,
    time_unit: str | None = None,
    title: str = "",
    axes: "Axes | None" = None,
) -> "Figure":
    """Displacement against time.

    Parameters
    ----------
    motion, t : a trajectory, or an array (k,) in m with its times [s]
    dof : index or name, or a list of them
    verdict : draws the course of its amplitude about the last mean, and its sentence's numbers in the corner
    name : what the axis calls the value
    unit, time_unit : "mm", "ms" and the like; by default what makes the largest value one or more
    axes : draw here instead of in a new figure
    """
    columns = list(dof) if isinstance(dof, (list, tuple)) else [dof]
    smooth = t is None and hasattr(motion, "qd")
    curves = [_drawn(motion, which)[:2] if smooth else values(motion, t, dof=which) for which in columns]
    kinds = {unit_at(getattr(motion, "system", None), which) for which in columns}
    if len(kinds) > 1:
        raise SignalError(f"dof = {dof}: displacements [m] and rotations [rad] do not share an axis; draw them apart")
    factor, read = scaled(kinds.pop(), *(x for _, x in curves), to=unit)
    second, clock = scaled("s", curves[0][0], to=time_unit)
    with drawing(axes) as panel:
        for i, (times, x) in enumerate(curves):
            label = _dof_name(motion, columns[i]) if len(columns) > 1 else None
            seen = _extremes(np.asarray(x))
            panel.plot(times[seen] / second, x[seen] / factor, label=label, **{**line(i), "linewidth": 0.7})
        if verdict is not None:
            for sign in (-1.0, 1.0):
                hull = (verdict.envelope_centre + sign * verdict.envelope) / factor
                panel.plot(verdict.envelope_time / second, hull, **{**line(2), "linewidth": 1.1})
            low, high = panel.get_ylim()
            panel.set_ylim(low, high + 0.15 * (high - low))
            note(panel, _verdict_note(verdict, unit_at(getattr(motion, "system", None), columns[0])))
        panel.set_xlim(curves[0][0][0] / second, curves[0][0][-1] / second)
        panel.set(xlabel=quantity_label("time", clock), ylabel=quantity_label(name, read), title=title)
        if len(columns) > 1:
            panel.legend(loc="upper right")
        return figure_of(panel)


def phase_plane(
    motion: MotionLike,
    *,
    dof: int | str = 0,
    part: float = 0.25,
    unit: str | None = None,
    speed_unit: str | None = None,
    title: str = "",
    axes: "Axes | None" = None,
) -> "Figure":
    """Velocity against displacement: the last `part` [-] of the time dark, before it pale, the start as a ring."""
    times, x, velocity = _drawn(motion, dof)
    system = getattr(motion, "system", None)
    factor, read = scaled(unit_at(system, dof), x, to=unit)
    speed, clock = scaled(unit_at(system, dof, moves=True), velocity, to=speed_unit)
    late = times >= times[-1] - part * (times[-1] - times[0])
    with drawing(axes, height=2.8) as panel:
        for drawn, looks in ((np.ones_like(late), ("#b0b0b0", 0.4)), (late, ("#000000", 0.8))):
            for some in _stretches(np.flatnonzero(drawn)):
                panel.plot(x[some] / factor, velocity[some] / speed, color=looks[0], linewidth=looks[1])
        panel.plot(x[0] / factor, velocity[0] / speed, "o", color="#D55E00", markerfacecolor="white", zorder=3)
        panel.set(xlabel=quantity_label("displacement", read), ylabel=quantity_label("velocity", clock), title=title)
        panel.margins(0.08)
        panel.locator_params(axis="x", nbins=5)
        return figure_of(panel)


def _drawn(motion: MotionLike, dof: int | str) -> tuple[Any, Any, Any]:
    """Times, displacement and velocity as they are drawn: through few steps a smooth curve, not a polygon."""
    times, x = values(motion, dof=dof)
    velocity = np.asarray(motion.qd)[:, column(motion, dof)]
    if times.size < LEAST or equal_steps(times):
        return times, x, velocity
    curve = smooth_curve(motion, dof=dof)
    fine = np.linspace(curve.begin, curve.end, max(times.size, SMOOTH * curve.turns.size))
    return fine, curve.spline(fine), curve.spline(fine, 1)


def _extremes(x: np.ndarray) -> Any:
    """Which points of a history are drawn: all, or of too many the least and the largest of each part."""
    width = x.size // (LARGEST // 4)
    if x.size <= LARGEST:
        return np.arange(x.size)
    whole = x.size - x.size % width
    parts, first = x[:whole].reshape(-1, width), np.arange(0, whole, width)
    return np.unique(np.r_[0, first + parts.argmin(axis=1), first + parts.argmax(axis=1), whole : x.size])


def _stretches(points: np.ndarray) -> list[Any]:
    """The points of a curve in one piece, or of too many some stretches spread over the whole."""
    if points.size <= LARGEST:
        return [points]
    return [part[: LARGEST // STRETCHES] for part in np.array_split(points, STRETCHES)]


def energy(
    trajectory: Trajectory, *, unit: str | None = None, title: str = "", axes: "Panels | None" = None
) -> "Figure":
    """Where the energy went, and by how much the audit fails to close; `axes` is a pair of panels.

    Above: work of the friction of each contact, of the load and of the skew stiffness, energy stored and, positive too
    though it is taken out, dissipated. Below: the residual over the largest energy turned over.
    """
    audit, times = trajectory.energy, trajectory.t
    names = trajectory.system.contact_names
    terms = [(f"friction, {name}", audit.friction[:, i]) for i, name in enumerate(names)]
    terms += [("load", audit.load), ("circulation", audit.circulation), ("dissipated (taken out)", audit.dissipated)]
    terms += [("opening of contacts", audit.opening), ("stored", audit.stored)]
    terms = [(name, term) for name, term in terms if np.any(term)] or terms[-1:]  # at rest there is none
    factor, read = scaled("J", *(term for _, term in terms), to=unit)
    second, clock = scaled("s", times)
    with drawing(axes, rows=2, width=4.6, height=4.0, sharex=True, height_ratios=[3, 1]) as (above, below):
        for i, (name, term) in enumerate(terms):
            above.plot(times / second, term / factor, label=name, **line(i, marker=True, count=times.size))
        above.set(ylabel=quantity_label("energy since the start", read), title=title)
        above.legend(loc="best")
        largest = max((float(np.max(np.abs(term))) for _, term in terms), default=0.0) or 1.0
        below.plot(times / second, audit.residual / largest, **line(0))
        below.set(xlabel=quantity_label("time", clock), ylabel=quantity_label("residual", ""))
        below.set_xlim(times[0] / second, times[-1] / second)
        return figure_of(above)


@drawn_by.register(Trajectory)
def motion_overview(trajectory: Trajectory, *, dof: int | str | None = None, title: str = "") -> "Figure":
    """Time history with the verdict, its last periods, spectrum and phase plane of one degree of freedom.

    The spectrum of a run with unequal steps is that of a smooth curve through them, and says so. A run too short to
    judge is drawn without verdict and spectrum, one of few periods without the last of them. dof None takes the freedom
    that moves most, and the axis names it.
    """
    trajectory = resolved(trajectory)  # what is drawn belongs to the motion, not to its instants
    names = trajectory.system.names
    if dof is None:
        dof = liveliest(np.ptp(trajectory.q, axis=0), trajectory.system.units)
    place = column(trajectory, dof)
    short = np.size(trajectory.t) < LEAST
    judged = None if short else verdict(trajectory, dof=dof)
    name, seconds = read_of(names, place), float(np.ptp(trajectory.t)) if np.size(trajectory.t) else 0.0
    if judged is not None and float(judged.frequency) * seconds > MANY:
        figure, axes = panels(2, 2, height=4.4, width_ratios=[1.4, 1.0])
        history, last, lines, plane = np.ravel(axes)
        begin = float(trajectory.t[-1] - LAST / judged.frequency)
        _last_periods(trajectory, begin, dof=dof, name=name, axes=last)
    else:
        figure, axes = panels(1, 2 if short else 3, height=2.5, width_ratios=[1.5, 1.0, 1.2][: 2 if short else 3])
        history, plane, lines = (*axes, None)[:3]
    time_history(trajectory, dof=dof, name=name, verdict=judged, axes=history)
    phase_plane(trajectory, dof=dof, axes=plane)
    if not short:
        even = equal_steps(trajectory.t)
        times, x = values(trajectory, dof=dof) if even else smooth_curve(trajectory, dof=dof).even()
        spectrum(x, times, axes=lines, quantity=unit_at(trajectory.system, place),
                 remark="" if even else "through unequal steps")  # fmt: skip
    if title or not trajectory.outcome.ok:
        ended = "" if trajectory.outcome.ok else trajectory.outcome.told
        figure.suptitle(". ".join(filter(None, (title, ended))), fontsize=8)
    return figure


@drawn_by.register(Verdict)
def amplitude_course(
    verdict: Verdict, *, unit: str | None = None, title: str = "", axes: "Axes | None" = None
) -> "Figure":
    """Course of the amplitude behind a verdict, on a logarithmic scale, with its sentence."""
    from matplotlib.ticker import LogLocator, NullFormatter

    factor, read = scaled("m", verdict.envelope, to=unit)
    second, clock = scaled("s", verdict.envelope_time)
    with drawing(axes) as panel:
        panel.semilogy(verdict.envelope_time / second, verdict.envelope / factor, **line(0))
        if np.isfinite(verdict.settled_at):
            panel.axvline(float(verdict.settled_at) / second, **{**line(2), "linewidth": 0.8})
        note(panel, _verdict_note(verdict))
        low, high = panel.get_ylim()
        panel.set_ylim(low, 2.0 * high)
        panel.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if high < 100.0 * low else (1.0,)))
        panel.yaxis.set_major_formatter(lambda value, _: number(value, 2))
        panel.yaxis.set_minor_formatter(NullFormatter())
        panel.set(xlabel=quantity_label("time", clock), ylabel=quantity_label("half peak to peak", read), title=title)
        return figure_of(panel)


def _last_periods(motion: Trajectory, begin: float, *, dof: int | str, name: str, axes: "Axes") -> None:
    """The end of a motion of many periods, close enough to see its shape."""
    times, x, _ = _drawn(motion, dof)
    curve = smooth_curve(motion, dof=dof, begin=begin) if np.sum(motion.t >= begin) >= LEAST else None
    if curve is not None:
        times = np.linspace(curve.begin, curve.end, 800)
        x = curve.spline(times)
    late = times >= begin
    factor, read = scaled(unit_at(motion.system, dof), x)
    second, clock = scaled("s", times)
    axes.plot(times[late] / second, x[late] / factor, **{**line(0), "linewidth": 0.8})
    axes.set(xlabel=quantity_label("time", clock), ylabel=quantity_label(name, read), title="the last periods")
    axes.set_xlim(times[late][0] / second, times[-1] / second)
    axes.locator_params(axis="x", nbins=4)


def _verdict_note(verdict: Verdict, unit: str = "m") -> str:
    text = verdict.kind.replace("_", " ")
    if verdict.kind == "settles_on_cycle":
        factor, read = scaled(unit, verdict.amplitude)
        return f"{text}: {number(verdict.amplitude / factor, 3)} {read}, {number(verdict.frequency / 1e3)} kHz"
    if np.isfinite(verdict.growth_rate):
        return f"{text}: {uncertain(verdict.growth_rate, verdict.growth_rate_error)} 1/s"
    return text


def _dof_name(motion: MotionLike, dof: int | str) -> str:
    if isinstance(dof, str):
        return dof
    if isinstance(motion, Trajectory):
        return motion.system.names[dof]
    raise SignalError(f"dof = {dof}: several degrees of freedom need a trajectory that names them")
