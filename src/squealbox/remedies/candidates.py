"""What might silence a brake: candidates, their doses and costs, and the line of Python that says them."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from squealbox.countermeasures import (
    AddedDamping,
    AddedMass,
    AddedStiffness,
    Asymmetry,
    Controlled,
    Dithered,
    LayerDamping,
    Shim,
    TunedMass,
    best_absorber,
)
from squealbox.design import Design
from squealbox.law import FrictionLaw
from squealbox.loops import PID, ActiveForce
from squealbox.parameters import Parameter, ParameterError
from squealbox.stability import complex_modes

LARGEST_CHANGE = 0.5  # of a parameter, up or down
LARGEST_TURN = np.deg2rad(15.0)
SHARES = (0.02, 0.05)  # masses of absorbers, of the mass they stand on
MOST_FREEDOMS = 3  # degrees of freedom looked at, those that move most in the worst mode
BANDWIDTH, FASTER = 20e3, 10.0  # Hz of the actuators, and times the worst mode's frequency that is enough
DOSES = 33


@dataclass(frozen=True)
class Candidate:
    """One cure: `make(dose)` is the brake with it, `doses` rise with the effort, `line(dose)` is it in Python.

    `make` takes an array of doses as well. cost says in words what it costs; cautions are known beforehand. `values`
    are the parameters of the brake that have another value with it, for a cure that is nothing else. A `slow` one is
    made for one dose at a time, and for fewer of them.
    """

    name: str
    make: Callable[[Any], Design]
    doses: Any
    unit: str
    line: Callable[[float], str]
    cost: Callable[[float], str]
    cautions: tuple[str, ...] = ()
    values: Callable[[float], dict[str, float]] | None = None
    slow: bool = False
    tuned: str = ""  # the parameter that scatters with production though the brake's data do not know it


def candidates_for(brake: Design, friction: Design) -> list[Candidate]:
    """Every candidate the brake itself suggests; `friction` is the brake at the friction it shall be quiet at.

    Absorbers are those of `best_absorber`, tuned to the brake as it is.
    """
    names = _freedoms(brake)
    masses = {name: float(brake.system().M[i, i]) for i, name in enumerate(brake.system().names)}
    springs = {name: float(brake.system().K[i, i]) for i, name in enumerate(brake.system().names)}
    modes = complex_modes(friction)
    rate = 2.0 * np.pi * float(modes.most_unstable.frequency or np.max(modes.frequency))
    found = [*_parameters(brake)]
    tuned = {
        (name, share): best_absorber(brake, name, share * masses[name]).design for name in names for share in SHARES
    }
    for name in names:
        found += [_absorber(tuned[name, share]) for share in SHARES]
        found += [
            _added(
                AddedDamping, "damping", brake, name, 3.0 * masses[name] * rate, "N s/m", "a damper or damping layer"
            ),
            _added(AddedMass, "mass", brake, name, 0.5 * masses[name], "kg", "weight"),
            _added(AddedStiffness, "stiffness", brake, name, 0.5 * springs[name], "N/m", "a stiffer support"),
            _layer(brake, name, rate / (2.0 * np.pi)),
        ]
    light = tuned[names[0], SHARES[0]]
    found.append(_absorber_and_damper(light, names[-1 if len(names) == 1 else 1], masses, rate))
    if len(names) > 1:
        found.append(_dampers(brake, names, 3.0 * max(masses[n] for n in names) * rate))
        found.append(_asymmetry(brake, names, 0.3 * min(springs[n] for n in names)))
        found.append(_two_absorbers(light, best_absorber(light, names[1], SHARES[0] * masses[names[1]]).design))
    found += _shims(brake, rate)
    bandwidth = min(BANDWIDTH, FASTER * rate / (2.0 * np.pi))
    found.append(_feedback(brake, names, 3.0 * max(masses[n] for n in names) * rate, bandwidth))
    found.append(_active(brake, names, masses, bandwidth))
    contacts = brake.system().contacts
    if contacts and not any(contact.law.has_memory for contact in contacts):  # bristles are not averaged over dither
        found += [_dither(brake), _dither_and_damper(brake, names[0], 3.0 * masses[names[0]] * rate)]
    return found


def _freedoms(brake: Design) -> list[str]:
    """The degrees of freedom with mass that move most in the worst mode."""
    system, modes = brake.system(), complex_modes(brake)
    moving = np.abs(modes.most_unstable.shape[: system.size])
    heavy = [i for i in range(system.size) if system.M[i, i] > 0.0]
    return [system.names[i] for i in sorted(heavy, key=lambda i: -moving[i])[:MOST_FREEDOMS]]


def _parameters(brake: Design) -> Iterator[Candidate]:
    """Each number of the design, up and down."""
    for path, about, value in brake.leaves():
        if np.ndim(value) or not isinstance(value, float) or value == 0.0 or "speed" in path.rpartition(".")[2]:
            continue
        in_friction = path.rpartition(".")[0].rpartition(".")[2] == "friction"
        for sign in (1.0, -1.0):
            if in_friction and (path.rpartition(".")[2] != "static" or sign > 0.0):
                continue  # of friction only less of it is a cure
            yield parameter_candidate(brake, path, about, value, sign)


def parameter_candidate(brake: Design, path: str, about: Parameter, value: float, sign: float) -> Candidate:
    """More (`sign` 1) or less (-1) of one parameter, by up to half of it."""
    turn = about.unit == "rad"
    most = sign * (LARGEST_TURN if turn else LARGEST_CHANGE * abs(value))
    low, high = about.low, about.high
    end = float(np.clip(value + most, low + 1e-9 * abs(value), high - 1e-9 * abs(value)))
    doses = (end - value) * np.linspace(0.0, 1.0, DOSES + 1)[1:]

    def make(dose: Any) -> Design:
        return brake.replace({path: value + dose})

    def cost(dose: float) -> str:
        amount = f"{np.rad2deg(dose):+.3g} deg" if turn else f"{100.0 * dose / value:+.3g} %"
        what = {"static": "brake torque", "load1": "brake torque", "load2": "brake torque"}.get(
            path.rpartition(".")[2], "redesign"
        )
        return f"{what}, {path} {amount}"

    return Candidate(
        f"{path} {'up' if sign > 0.0 else 'down'}", make, doses, about.unit,
        lambda dose: f"brake.replace({{{path!r}: {value + dose!r}}})", cost,
        values=lambda dose: {path: value + dose},
    )  # fmt: skip


def _added(kind: Any, field: str, brake: Design, on: str, most: float, unit: str, what: str) -> Candidate:
    cautions: tuple[str, ...] = ()
    if kind is AddedDamping:
        cautions = (f"damping on {on} alone can destabilise a flutter pair",)
    return Candidate(
        f"{field} on {on}", lambda dose: kind(brake, on, dose), np.geomspace(1e-3, 1.0, DOSES) * most, unit,
        lambda dose: f"{kind.__name__}(brake, {on!r}, {float(dose)!r})",
        lambda dose: f"{what}, {dose:.4g} {unit}", cautions,
    )  # fmt: skip


def _absorber(tuned: TunedMass) -> Candidate:
    brake, on, mass, frequency, damping = tuned.brake, tuned.on, tuned.mass, tuned.frequency, tuned.damping
    return Candidate(
        f"absorber {1e3 * mass:.3g} g on {on}", lambda dose: TunedMass(brake, on, dose, frequency, damping),
        np.array([mass]), "kg",
        lambda dose: f"TunedMass(brake, {on!r}, {float(dose)!r}, {frequency!r}, {damping!r})",
        lambda dose: f"{1e3 * dose:.3g} g, tuned to {frequency:.5g} Hz and {100.0 * damping:.3g} %",
        ("an absorber is narrow: its tuning must be held in production and over temperature",), tuned="frequency",
    )  # fmt: skip


def _dampers(brake: Design, names: list[str], most: float) -> Candidate:
    def make(dose: Any) -> Design:
        found = brake
        for name in names:
            found = AddedDamping(found, name, dose)
        return found

    def line(dose: float) -> str:
        text = "brake"
        for name in names:
            text = f"AddedDamping({text}, {name!r}, {float(dose)!r})"
        return text

    return Candidate(
        f"dampers on {' and '.join(names)}", make, np.geomspace(1e-3, 1.0, DOSES) * most, "N s/m", line,
        lambda dose: f"a damping shim, {dose:.4g} N s/m on each",
    )  # fmt: skip


def _asymmetry(brake: Design, names: list[str], most: float) -> Candidate:
    on, against = names[:2]
    doses = np.geomspace(1e-3, 1.0, DOSES) * most
    return Candidate(
        f"asymmetry {on}/{against}", lambda dose: Asymmetry(brake, on, against, dose), doses, "N/m",
        lambda dose: f"Asymmetry(brake, {on!r}, {against!r}, {float(dose)!r})",
        lambda dose: f"redesign, {dose:.4g} N/m",
    )  # fmt: skip


def _layer(brake: Design, on: str, hertz: float) -> Candidate:
    return Candidate(
        f"layer on {on}", lambda dose: LayerDamping(brake, on, 1.0, dose, None, hertz),
        np.geomspace(1e-3, 1.0, DOSES), "",
        lambda dose: f"LayerDamping(brake, {on!r}, 1.0, {float(dose)!r}, None, {hertz!r})",
        lambda dose: f"constrained layer, Y = {dose:.3g}",
        ("a layer's loss is that at one temperature", f"damping on {on} alone can destabilise a flutter pair"),
    )  # fmt: skip


def _absorber_and_damper(light: TunedMass, other: str, masses: dict[str, float], rate: float) -> Candidate:
    """A light absorber on what moves most, with a damper on the other freedom."""
    inner = f"TunedMass(brake, {light.on!r}, {light.mass!r}, {light.frequency!r}, {light.damping!r})"
    return Candidate(
        f"absorber on {light.on} and damper on {other}",
        lambda dose: AddedDamping(light, other, dose),
        np.geomspace(1e-3, 1.0, DOSES) * masses[other] * rate, "N s/m",
        lambda dose: f"AddedDamping({inner}, {other!r}, {float(dose)!r})",
        lambda dose: f"{1e3 * light.mass:.3g} g and {dose:.4g} N s/m", tuned="brake.frequency",
    )  # fmt: skip


def _two_absorbers(light: TunedMass, both: TunedMass) -> Candidate:
    other, frequency, damping = both.on, both.frequency, both.damping
    inner = f"TunedMass(brake, {light.on!r}, {light.mass!r}, {light.frequency!r}, {light.damping!r})"
    return Candidate(
        f"absorbers on {light.on} and {other}",
        lambda dose: TunedMass(light, other, dose, frequency, damping),
        np.array([both.mass]), "kg",
        lambda dose: f"TunedMass({inner}, {other!r}, {float(dose)!r}, {frequency!r}, {damping!r})",
        lambda dose: f"{1e3 * (light.mass + dose):.3g} g in all", ("two absorbers to be tuned",), tuned="frequency",
    )  # fmt: skip


def _shims(brake: Design, rate: float) -> Iterator[Candidate]:
    for contact in brake.system().contacts:
        spring = float(np.linalg.norm(contact.n))
        try:
            Shim(brake, contact.name, max(spring, 1.0)).system()
        except ParameterError:
            continue  # a contact without a spring of its own has nothing a shim could stand in series with
        yield _shim(brake, contact.name, spring, rate / (2.0 * np.pi))


def _shim(brake: Design, name: str, spring: float, hertz: float) -> Candidate:
    return Candidate(
        f"shim at {name}", lambda dose: Shim(brake, name, 1.0 / dose, 0.3, hertz),
        np.geomspace(0.01, 10.0, DOSES) / spring, "m/N",
        lambda dose: f"Shim(brake, {name!r}, {1.0 / float(dose)!r}, 0.3, {hertz!r})",
        lambda dose: f"a shim of {1.0 / dose:.4g} N/m with loss factor 0.3",
        ("a soft shim lengthens the pedal travel",),
    )  # fmt: skip


def _feedback(brake: Design, names: list[str], most: float, bandwidth: float) -> Candidate:
    def make(dose: Any) -> Design:
        return Controlled(brake, tuple(PID(on=name, derivative=dose, bandwidth=bandwidth) for name in names))

    def line(dose: float) -> str:
        loops = ", ".join(f"PID(on={name!r}, derivative={float(dose)!r}, bandwidth={bandwidth!r})" for name in names)
        return f"Controlled(brake, [{loops}])"

    return Candidate(
        f"velocity feedback on {' and '.join(names)}", make, np.geomspace(1e-3, 1.0, DOSES) * most, "N s/m", line,
        lambda dose: f"actuators of {bandwidth / 1e3:.3g} kHz, {dose:.4g} N s/m",
    )  # fmt: skip


def _active(brake: Design, names: list[str], masses: dict[str, float], bandwidth: float) -> Candidate:
    share = 0.1 * min(masses[name] for name in names)

    def make(dose: Any) -> Design:
        loops = [ActiveForce(share, share / dose, on=name, bandwidth=bandwidth) for name in names]
        return Controlled(brake, tuple(loops))

    def line(dose: float) -> str:
        loops = ", ".join(
            f"ActiveForce({share!r}, {share / float(dose)!r}, on={name!r}, bandwidth={bandwidth!r})" for name in names
        )
        return f"Controlled(brake, [{loops}])"

    system = brake.system()
    most = 3.0 * share * 10.0 * float(np.sqrt(np.max(np.abs(system.K)) / np.max(system.M)))
    return Candidate(
        f"active force control on {' and '.join(names)}", make, np.geomspace(1e-3, 1.0, DOSES) * most, "N s/m", line,
        lambda dose: f"actuators of {bandwidth / 1e3:.3g} kHz with accelerometers, filter {1e6 * share / dose:.3g} us",
    )  # fmt: skip


def _dither(brake: Design) -> Candidate:
    speed = max(abs(float(np.max(s))) for s in np.atleast_1d(_speeds(brake)))
    return Candidate(
        "tangential dither", lambda dose: Dithered(brake, dose), speed * np.geomspace(1.02, 5.0, DOSES), "m/s",
        lambda dose: f"Dithered(brake, {float(dose)!r})", lambda dose: f"piezo actuators, {dose:.4g} m/s, brake torque",
    )  # fmt: skip


def _dither_and_damper(brake: Design, on: str, most: float) -> Candidate:
    """Dither well beyond the sliding speed, where no contact is near its turning, and a damper."""
    velocity = 2.0 * max(abs(float(np.max(s))) for s in np.atleast_1d(_speeds(brake)))
    return Candidate(
        f"dither and damper on {on}",
        lambda dose: AddedDamping(Dithered(brake, velocity), on, dose), np.geomspace(1e-3, 1.0, DOSES) * most, "N s/m",
        lambda dose: f"AddedDamping(Dithered(brake, {velocity!r}), {on!r}, {float(dose)!r})",
        lambda dose: f"piezo, {velocity:.3g} m/s, brake torque, {dose:.4g} N s/m",
    )  # fmt: skip


def _speeds(brake: Design) -> Any:
    from squealbox.system import equilibrium

    return equilibrium(brake.system()).sliding_speed


def more_friction(brake: Design, factor: float | np.ndarray) -> Design:
    """The brake with every friction coefficient of its laws times `factor`."""
    laws = list(laws_of(brake))
    if not laws:
        raise ParameterError("silence", "brake", type(brake).__name__, "a design with a friction law")
    return brake.replace({
        f"{path}.{name}": np.asarray(getattr(sheet, name)) * factor
        for path, sheet in laws for name, about in sheet.parameters().items()
        if about.unit == "-" and getattr(sheet, name) is not None
    })  # fmt: skip


def laws_of(design: Design, prefix: str = "") -> Iterator[tuple[str, FrictionLaw]]:
    """The friction laws of a design and of the brake within it, each with its name."""
    for name in design.field_names():
        value = getattr(design, name)
        if isinstance(value, FrictionLaw):
            yield prefix + name, value
        elif isinstance(value, Design):
            yield from laws_of(value, f"{prefix}{name}.")
