"""Which design is best? Goals and constraints, the search, and the optimum with its Pareto front.

The names are public in `squealbox.studies`. Depends on: studies/quantity, studies/uncertainty, result, parameters.
"""
