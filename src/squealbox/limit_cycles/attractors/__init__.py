"""What motions end in, told by many of them: attractors, basins, pushes, diagrams, regions of coexistence.

`settling` runs ensembles until they rest or repeat, `attractor` tells what they ended in apart, `sections` and
`exponents` look at single motions. Depends on: branches, cycles, transient.
"""
