"""Friction laws: the coefficient mu(|v|) at sliding speed |v|, and its slope dmu/d|v|.

Each law is one plain formula ``law(v, p)`` and its derivative ``law_slope(v, p)`` of the speed v >= 0 and the law's
coefficients p. The same functions serve NumPy arrays here and are compiled by the transient engine, so they use only
arithmetic and NumPy functions. By convention p[0] is the static limit, the coefficient a sticking contact can reach.
A file of this folder that holds a law makes it one of `LAWS`.
"""

from squealbox.bristles import Dahl, ElastoPlastic, LuGre
from squealbox.friction import curves
from squealbox.friction.averaging import Averaged, averaged
from squealbox.friction.curves import Coulomb, Cubic, Hyperbolic, LinearSlope, Stribeck, Table
from squealbox.friction.own import OwnLaw, allow, law_from_file, own_law
from squealbox.law import NEVER_STICKS, FrictionLaw
from squealbox.registers import kinds_in, name_of

# Their places are numbers in compiled code: what is found in further files stands behind these.
_FIRST = (Coulomb, LinearSlope, Stribeck, Hyperbolic, Cubic, Table, LuGre, Dahl, ElastoPlastic)
LAWS: tuple[type[FrictionLaw], ...] = kinds_in(__name__, FrictionLaw, _FIRST, having="formula")
LAW_NAMES: dict[str, type[FrictionLaw]] = {name_of(law): law for law in LAWS}  # as files and pages write them
globals().update({law.__name__: law for law in LAWS})
_formulas = (each for law in LAWS for each in (law.formula, law.slope_formula))
globals().update({each.__name__: each for each in _formulas if each.__module__ == curves.__name__})

__all__ = [
    "LAWS", "LAW_NAMES", "NEVER_STICKS", "Averaged", "FrictionLaw", "OwnLaw", "allow", "averaged", "law_from_file",
    "own_law",
]  # fmt: skip
__all__ += [law.__name__ for law in LAWS]
