"""A study of many points as labelled data. Each part behind `# %%` is a cell of study.ipynb."""

# %% Ask the modes at every point of a grid
import numpy as np

from squealbox import DrumBrake, LinearSlope, complex_modes, plot, simulate_ensemble, sweep

brake = DrumBrake(friction=LinearSlope(static=0.3, slope=-0.05))
table = sweep(
    brake, {"friction.static": np.linspace(0.1, 0.5, 41), "load": np.linspace(500.0, 4000.0, 15)}, complex_modes
)
print(table)
plot(table)

# %% One column of it, by names and values
print(table["largest_growth_rate"].sel({"load": 1000.0}).max("friction.static").item())
print(table.to_dataframe().head(3))

# %% And what motions become, two hundred at once
runs = simulate_ensemble(brake, {"friction.static": np.linspace(0.2, 0.45, 200)}, 0.03)
print(runs["amplitude"].max())
plot(runs)
