"""Numbers of a brake that a study varies, by the analyses of the house. Depends on: studies, stability, transient.

    squeal_probability(brake, scatter, quantities.margin("friction.static", (0, 1)))

Each function here returns a `Quantity`: one number of a design, with its unit and the limit at which squeal begins.
All take designs of arrays in one batched call. Any plain function of a design serves a study as well.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from squealbox.family import Bounds, Family, Varied
from squealbox.parameters import DataSheet, ParameterError
from squealbox.stability import eigenvalues_of, first_crossings, largest_growth, steady_sliding
from squealbox.studies import Quantity
from squealbox.system import DesignOrSystem
from squealbox.transient import simulate_ensemble


def growth_rate(*, limit: float = 0.0, time: float = 0.0) -> Quantity:
    """The largest growth rate of steady sliding [1/s]; above `limit` [1/s] the brake squeals.

    `time` [s]: instant at which schedules are taken.

    Round-off about an undamped mode counts as zero. It has a kink where two modes meet, so a polynomial follows it
    badly there: `critical_value` and `margin` are smooth.

    >>> from squealbox.designs import ModeCoupling
    >>> growth_rate()(ModeCoupling(k3=[0.5, 1.5])) > 0.0
    array([False, False])
    """

    def largest(design: DesignOrSystem) -> Any:
        growth, _, growing = largest_growth(steady_sliding(design, time))
        return np.where((growth > 0.0) & (growing == 0), 0.0, growth)

    return Quantity(largest, "growth rate", "1/s", limit, smooth=False, meaning="largest growth rate")


def damping_ratio(*, limit: float = 0.0, time: float = 0.0) -> Quantity:
    """The least damping ratio of steady sliding, -Re lambda / |lambda| [-]; below `limit` [-] the brake squeals.

    `time` [s]: instant at which schedules are taken.

    >>> from squealbox.designs import MassOnBelt
    >>> damping_ratio()(MassOnBelt()).shape
    ()
    """

    def least(design: DesignOrSystem) -> Any:
        values = eigenvalues_of(steady_sliding(design, time))
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.min(-values.real / np.abs(values), axis=-1)

    return Quantity(least, "damping ratio", "", limit, "below", smooth=False, meaning="least damping ratio")


def critical_value(
    parameter: Varied, bounds: Bounds | None = None, *, limit: float, unit: str = "", points: int = 65
) -> Quantity:
    """The value of a parameter at which squeal begins; below `limit` [SI] the brake squeals.

    parameter and `bounds` [SI] : {name: (low, high)}, or the name and the bounds one after the other.
    `limit` is the value the brake runs at. Infinite where sliding is stable all over the bounds, minus infinite where
    it is unstable at the lower one.
    """
    about = Family.within("critical_value", None, parameter, bounds)

    def critical(design: DesignOrSystem) -> Any:
        return first_crossings(design, about.name, about.spans[0], points=points)

    return Quantity(critical, f"critical {about.name}", unit, limit, "below", meaning="where squeal begins")


def margin(parameter: Varied, bounds: Bounds | None = None, *, unit: str = "", points: int = 65) -> Quantity:
    """How far a parameter is below the value at which squeal begins, in its own unit; below 0 the brake squeals.

    parameter and `bounds` [SI] : {name: (low, high)}, or the name and the bounds one after the other.
    It is smooth where the growth rate has its kink. Infinite where stability does not change within the bounds.

    >>> from squealbox.designs import ModeCoupling
    >>> from squealbox.friction import Coulomb
    >>> round(float(margin({"friction.static": (0.0, 2.0)})(ModeCoupling(friction=Coulomb(0.4)))), 9)
    0.6
    """
    about = Family.within("margin", None, parameter, bounds)

    def distance(design: DataSheet) -> Any:
        return first_crossings(design, about.name, about.spans[0], points=points) - design.value_of(about.name)

    return Quantity(distance, f"margin of {about.name}", unit, 0.0, "below", meaning="distance to the onset of squeal")


def amplitude(duration: float = 0.05, *, limit: float, contact: str = "exact", rtol: float | None = None) -> Quantity:
    """The largest amplitude of a transient from rest [m], over its last fifth; above `limit` [m] the brake squeals.

    `rtol` [-]: relative tolerance of the integration.

    By `simulate_ensemble` over `duration` [s]; NaN for a transient that does not reach its end.
    """

    def largest(design: DesignOrSystem) -> Any:
        many = simulate_ensemble(design, None, duration, observe=("amplitude",), contact=contact, rtol=rtol)
        return np.where(many.ended == "completed", np.max(many["amplitude"], axis=-1), np.nan)

    return Quantity(largest, "amplitude", "m", limit, smooth=False, meaning="amplitude in the end")


def parameter_value(parameter: str, *, unit: str = "") -> Quantity:
    """The value of one parameter of the design itself, such as a mass, to be a goal or a bound of `optimise`."""
    return weighted_sum({parameter: 1.0}, name=parameter, unit=unit)


def weighted_sum(weights: Mapping[str, float], *, name: str = "weighted sum", unit: str = "") -> Quantity:
    """sum_i w_i x_i over parameters of the design: a mass, a cost.

    >>> from squealbox.designs import DampingParadox
    >>> float(weighted_sum({"eta1": 100.0, "eta2": 50.0}, name="cost")(DampingParadox(eta1=0.02, eta2=0.01)))
    2.5
    """
    if not weights:
        raise ParameterError("weighted_sum", "weights", weights, "parameters with a number each, at least one")
    kept = {str(path): float(weight) for path, weight in weights.items()}

    def total(design: DataSheet) -> Any:
        parts = np.broadcast_arrays(*(weight * np.asarray(design.value_of(path)) for path, weight in kept.items()))
        return np.broadcast_to(np.sum(parts, axis=0), _shape_of(design))

    return Quantity(total, name, unit, meaning="weighted sum of parameters")


def _shape_of(design: DataSheet) -> tuple[int, ...]:
    """The leading axes of a design of arrays."""
    return np.broadcast_shapes(*(np.shape(value) for _, _, value in design.leaves() if np.ndim(value) == 1))
