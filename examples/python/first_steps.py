"""A drum brake from onset to limit cycle. Each part behind `# %%` is a cell of first_steps.ipynb."""

# %% Is steady sliding stable, from which friction on is it not, and by which mechanism?
from squealbox import (
    DrumBrake,
    LinearSlope,
    complex_modes,
    critical_value,
    mechanism,
    plot,
    shooting,
    simulate,
    verdict,
)

brake = DrumBrake(friction=LinearSlope(static=0.45, slope=-0.05))
print(complex_modes(brake))
print(critical_value(brake, {"friction.static": (0.0, 0.6)}))
print(mechanism(brake))

# %% What happens in time, with exact stick and slip?
motion = simulate(brake, duration=0.05)
print(verdict(motion))
plot(motion)

# %% What does it settle to?
cycle = shooting(brake, start=motion)
print(cycle)
plot(cycle)
