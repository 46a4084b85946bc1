from .base import Countermeasure
from .best import BestAbsorber, best_absorber
from .controlled import Controlled
from .dither import Dithered, NormalDither
from .kinds import COUNTERMEASURES
from .mechanical import AddedDamping, AddedMass, AddedStiffness, Asymmetry, TunedMass
from .settings import AbsorberSettings, DitherSettings
from .shims import LayerDamping, Shim, ross_kerwin_ungar

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
