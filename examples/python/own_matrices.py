"""A brake from one's own matrices, with a name for a number in them. Each part behind `# %%` is a cell."""

# %% A contact spring stands in K and in the normal force at once: a part with a name
import numpy as np

from squealbox import Coulomb, OwnBrake, OwnContact, Part, critical_value, plot, sensitivity, stability_map

brake = OwnBrake(
    M=np.diag([1.0, 1.0, 2.0]),
    C=10.0 * np.eye(3),
    K=[[3.8e6, 1e6, 0.0], [1e6, 1e6, -0.5e6], [0.0, -0.5e6, 2e6]],
    contacts=(OwnContact(name="pad", n=[0.0, 0.0, 0.0], d=[1.0, 0.0, 0.0]),),
    parts=(Part("k_pad", 3e6, K=np.diag([0.0, 1.0, 0.0]), n=[[0.0, 1.0, 0.0]]),),
    friction=Coulomb(0.9),
    normal_force=500.0,
    names=("pad_x", "pad_y", "disc_y"),
)
print(critical_value(brake, "k_pad", (0.0, 1e7)))
print(sensitivity(brake))

# %% And a map over it
found = stability_map(brake, {"k_pad": np.linspace(0.5e6, 8e6, 61), "friction.static": np.linspace(0.0, 1.0, 61)})
print(found)
plot(found)
