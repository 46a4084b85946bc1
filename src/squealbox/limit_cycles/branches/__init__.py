"""Cycles over a parameter, and over two: where they are born, how they go on, and the points at which they change.

`branch` walks a path (`walks`, by `shooting_path` or `harmonic_path`) past `corners` and solves for `special_points`;
`isolated` finds branches by runs, `hopf`, `curves` and `point_curves` follow onset and points over two parameters.
Depends on: cycles, continuation.
"""
