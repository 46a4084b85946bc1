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
    from squealbox.countermeasures.settings import AbsorberSettings, DitherSettings

# The search is loaded when it is first asked for: designs with a countermeasure need no analysis.
LATER = {"best": ["BestAbsorber", "best_absorber"], "settings": ["AbsorberSettings", "DitherSettings"]}
__getattr__, _, _ = lazy_loader.attach(__name__, submod_attrs=LATER)

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
    "AbsorberSettings",
    "AddedDamping",
    "AddedMass",
    "AddedStiffness",
    "Asymmetry",
    "BestAbsorber",
    "Controlled",
    "Countermeasure",
    "DitherSettings",
    "Dithered",
    "LayerDamping",
    "NormalDither",
    "Shim",
    "TunedMass",
    "best_absorber",
    "ross_kerwin_ungar",
]
