"""Which method a run takes: its usual one, or that which was named, with the usual tolerances or those given."""

from dataclasses import replace
from typing import Any

import numpy as np

from squealbox import friction, schedules
from squealbox.friction import FrictionLaw
from squealbox.parameters import ParameterError
from squealbox.schedules import Schedule
from squealbox.system import InvalidSystem, System
from squealbox.transient.latest import Latest
from squealbox.transient.methods import TAYLOR, Method
from squealbox.transient.one_motion import shares_vary
from squealbox.transient.own_laws import texts_of, untraced

USUAL = Latest()
LARGE = 160  # products of an acceleration up to which a generated step is written out


def check_series(system: System, contact: str) -> None:
    """A method that was named and cannot serve is refused."""
    if contact != "exact":
        expected = "exact: a Taylor series does not see a jump of sgn, and a smoothed one makes its steps tiny"
        raise ParameterError("simulate", "contact", contact, expected)
    if why := no_series(system):
        raise InvalidSystem(f"{why}: take another method than {TAYLOR}")


def usual_method(system: System, contact: str) -> str:
    """The method of a run that names none: a Taylor series wherever the equation has one for the generated step."""
    found: str = USUAL.of(system, contact, lambda: _usual_method(system, contact))
    return found


def _usual_method(system: System, contact: str) -> str:
    rooted = any(texts_of(c.law) and has_root_at_rest(c.law) for c in system.contacts)
    return (
        TAYLOR
        if contact == "exact" and is_small(system) and not rooted and not no_series(system)
        else "dormand-prince-8"
    )


def is_small(system: System) -> bool:
    """Whether a generated step of the system is written out, and so compiled in a second or two."""
    n, m = system.size, len(system.contacts)
    return n * (2 * n + 4 * m) + m * m <= LARGE


def has_root_at_rest(law: FrictionLaw) -> bool:
    """Whether mu(v) leaves zero speed like a root of v, which has no series there: its quotients grow without bound."""
    near, far = (np.max(np.abs(np.asarray(law.mu(v)) - law.mu(0.0))) / v for v in (1e-12, 1e-6))
    return bool(near > 10.0 * far and near > 1e-2)


def no_series(system: System) -> str:
    """Why the generated step of a Taylor series cannot run the system; empty where it can."""
    contacts = system.contacts
    if any(loop.sampling is None and not loop.linear for loop in system.loops):
        return "what a loop is late by is known at instants, and has no Taylor series"
    if any(contact.rigid for contact in contacts):
        return "a rigid contact has impacts"
    values = [system.load, *(value for c in contacts for value in (c.V, c.N0))]
    parts = [part for value in values if isinstance(value, Schedule) for _, part in value.terms()]
    if any(isinstance(part, schedules.Table) for part in parts):
        return "a schedule of measured points has no Taylor series"
    if any(isinstance(c.law, friction.Table) for c in contacts):
        return "a friction law of measured points has no Taylor series"
    if system.shape == () and shares_vary(system):
        return "contacts that hold the same motion share its force by limits that vary within a step"
    return next((why for c in contacts if (own := texts_of(c.law)) and (why := untraced(own[0]))), "")


def chosen_method(method: str | Method, rtol: float | None, atol: Any) -> Method:
    """A method with its usual tolerances, or those given."""
    chosen = method if isinstance(method, Method) else Method(method)
    given = {"rtol": rtol, "atol": atol}
    return replace(chosen, **{name: value for name, value in given.items() if value is not None})
