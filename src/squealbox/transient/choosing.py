"""Which method a run takes: its usual one, or that which was named, with the usual tolerances or those given."""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.law import FrictionLaw
from squealbox.parameters import ParameterError
from squealbox.system import InvalidSystem, System
from squealbox.transient.latest import Latest
from squealbox.transient.methods import TAYLOR, Method, tableau
from squealbox.transient.one_motion import shares_vary
from squealbox.transient.own_laws import texts_of, untraced

USUAL = Latest()
LARGE = 160  # products of an acceleration up to which a generated step is written out at once
SERIES = 4  # stages that take as long to compile as a series
LONGEST = 6_000  # products in all stages, which compile in half a minute
EACH = 0.5  # runs by the scalar march in the time that one more product takes to compile


def check_scheme(owner: str, method: Method, contact: str) -> None:
    """A series is not asked to jump."""
    if method.tableau == TAYLOR and contact == "raw":
        expected = "exact, or a smoothed sgn: a Taylor series does not see a jump of sgn"
        raise ParameterError(owner, "contact", contact, expected)


def check_series(system: System) -> None:
    """A series that was named and cannot serve is refused."""
    if why := no_series(system):
        raise InvalidSystem(f"{why}: take another method than {TAYLOR}")


def usual_method(system: System, contact: str, count: int = 1) -> str:
    """The method of a run, or of so many, that name none: a Taylor series wherever the equation has one and to write
    its step out pays.
    """
    worth = pays(system, TAYLOR, count)
    found: str = USUAL.of(system, (contact, worth), lambda: _usual_method(system, contact, worth))
    return found


def _usual_method(system: System, contact: str, worth: bool) -> str:
    rooted = any(texts_of(c.law) and has_root_at_rest(c.law) for c in system.contacts)
    return TAYLOR if contact != "raw" and worth and not rooted and not no_series(system) else "dormand-prince-8"


def is_small(system: System) -> bool:
    """Whether a generated step of the system is written out, and so compiled in a second or two."""
    return products(system) <= LARGE


def has_step(system: System, contact: str) -> bool:
    """Whether a single run of a Runge-Kutta method goes by a generated step.

    With events it would be a kernel of 2 s for each shape and method, where one march serves all.
    """
    return is_small(system) and system.size > 0 and (contact != "exact" or not system.contacts)


def products(system: System) -> int:
    """How many products an acceleration takes."""
    n, m = system.size, len(system.contacts)
    return n * (2 * n + 4 * m) + m * m


def pays(system: System, method: str, count: int) -> bool:
    """Whether to compile a step written out for so many runs takes less time than the scalar march of each."""
    written = products(system) * (SERIES if method == TAYLOR else tableau(method).stages)
    return is_small(system) or (written <= LONGEST and count > EACH * written)


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
    if system.shape == () and shares_vary(system):
        return "contacts that hold the same motion share its force by limits that vary within a step"
    return next((why for c in contacts if (own := texts_of(c.law)) and (why := untraced(own[0]))), "")


def chosen_method(method: str | Method, rtol: float | None, atol: ArrayLike | None) -> Method:
    """A method with its usual tolerances, or those given."""
    chosen = method if isinstance(method, Method) else Method(method)
    given: dict[str, Any] = {"rtol": rtol, "atol": atol}
    return replace(chosen, **{name: value for name, value in given.items() if value is not None})
