"""What is done against squeal: designs that hold a design. Depends on: designs, system, friction, loops, stability."""

from typing import TYPE_CHECKING

import lazy_loader

from squealbox.countermeasures.base import Countermeasure
from squealbox.countermeasures.controlled import Controlled
from squealbox.countermeasures.dither import Dithered, NormalDither
from squealbox.countermeasures.mechanical import AddedDamping, AddedMass, AddedStiffness, Asymmetry, TunedMass
from squealbox.countermeasures.shims import LayerDamping, Shim, ross_kerwin_ungar

if TYPE_CHECKING:
    from squealbox.countermeasures.best import BestAbsorber, best_absorber

# The search is loaded when it is first asked for: designs with a countermeasure need no analysis.
__getattr__, _, _ = lazy_loader.attach(__name__, submod_attrs={"best": ["BestAbsorber", "best_absorber"]})

COUNTERMEASURES: dict[str, type[Countermeasure]] = {
    "tuned_mass": TunedMass,
    "added_mass": AddedMass,
    "added_stiffness": AddedStiffness,
    "added_damping": AddedDamping,
    "shim": Shim,
    "layer_damping": LayerDamping,
    "asymmetry": Asymmetry,
    "dithered": Dithered,
    "normal_dither": NormalDither,
}

__all__ = [
    "COUNTERMEASURES",
    "AddedDamping",
    "AddedMass",
    "AddedStiffness",
    "Asymmetry",
    "BestAbsorber",
    "Controlled",
    "Countermeasure",
    "Dithered",
    "LayerDamping",
    "NormalDither",
    "Shim",
    "TunedMass",
    "best_absorber",
    "ross_kerwin_ungar",
]
