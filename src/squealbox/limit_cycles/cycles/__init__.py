"""One cycle: the motion with its derivative across events, and the two roads to a periodic one.

`field` is the equation with each contact in a mode, `saltation` and `variation` its derivative over a time,
`remembering` and `differences` the same of a system with other states, from its motion alone; `starting` is a first
guess; `shooting` and `harmonic_balance` return a `cycle`. Depends on: transient, stability, system.
"""
