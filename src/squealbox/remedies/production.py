"""How parameters scatter in production where nobody says: a stated assumption, not knowledge of this brake."""

from squealbox.design import Design
from squealbox.distributions import Lognormal, TruncatedNormal
from squealbox.fe import ReducedBrake
from squealbox.parameters import ParameterError
from squealbox.scatter import Scatter

FRICTION, SPRINGS, DAMPERS = 0.08, 0.03, 0.20  # coefficients of variation
REDUCED_LOT = 24  # brakes, each of which costs a spectrum of its band
LOT, LEAST_LOT, SMALL = 2048, 128, 20  # brakes, and degrees of freedom up to which LOT of them take seconds
ASSUMED = (
    f"Assumed scatter, since none was given: friction {100.0 * FRICTION:.0f} %, stiffnesses {100.0 * SPRINGS:.0f} %, "
    f"dampers {100.0 * DAMPERS:.0f} % (standard deviation over mean)"
)


def lot_size(brake: Design, most: int = LOT) -> int:
    """Brakes in the lot of a brake of n degrees of freedom: the fewer the larger, as a spectrum costs n^2 to n^3."""
    if isinstance(brake, ReducedBrake):
        return REDUCED_LOT
    return max(LEAST_LOT, int(most * min(1.0, (SMALL / brake.system().size) ** 2)))


def usual_scatter(brake: Design) -> Scatter:
    """Static friction with 8 %, stiffnesses with 3 % and dampers with 20 % standard deviation over mean.

    Static friction is cut off at the kinetic coefficient, the others are lognormal, so that all stay in their ranges.
    Only scalar parameters that are not zero scatter. Source: assumed, in the order of what suppliers of linings allow;
    a `Scatter` of one's own replaces it. Raises `ParameterError` where the brake has no such parameter.

    >>> from squealbox import MassOnBelt
    >>> usual_scatter(MassOnBelt()).names
    ('k', 'friction.static')
    """
    found: dict[str, Lognormal | TruncatedNormal] = {}
    values = {name: value for name, _, value in brake.leaves()}
    for name, about, value in brake.leaves():
        if not isinstance(value, float) or value <= 0.0:
            continue
        if name.endswith("static"):
            kinetic = values.get(f"{name.removesuffix('static')}kinetic")
            low = float(kinetic) if isinstance(kinetic, float) else 0.0
            found[name] = TruncatedNormal(value, FRICTION * value, low=low)
        elif about.unit in ("N/m", "N s/m"):
            share = SPRINGS if about.unit == "N/m" else DAMPERS
            found[name] = Lognormal(value, share * value)
    if not found:
        raise ParameterError("silence", "scatter", None, "a Scatter: this brake has no friction, stiffness or damper "
                             "of its own that could scatter")  # fmt: skip
    return Scatter(found)
