"""How sure is the answer? Distributions of scattering parameters, and what becomes of the answer over them.

Probability of squeal by sampling, FORM and subset simulation; Sobol' indices and Morris effects; polynomial chaos;
bounds over intervals. `scatter.py` draws the samples, each other file is one question. The names are public in
`squealbox.studies`. Depends on: studies/quantity, result, parameters.
"""
