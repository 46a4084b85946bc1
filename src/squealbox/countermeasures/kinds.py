"""What files, the command line and the page call each countermeasure."""

from squealbox.countermeasures.base import Countermeasure
from squealbox.countermeasures.dither import Dithered, NormalDither
from squealbox.countermeasures.mechanical import AddedDamping, AddedMass, AddedStiffness, Asymmetry, TunedMass
from squealbox.countermeasures.shims import LayerDamping, Shim

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
