"""Every friction law, by examples: the tests of all laws are asked of each of these."""

from squealbox import friction

LAWS = [
    friction.Coulomb(0.4, 0.25),
    friction.Coulomb(0.4),
    friction.LinearSlope(0.4, -0.5),
    friction.LinearSlope(0.4, -0.5, 0.2),
    friction.Stribeck(0.4, 0.25, 0.3),
    friction.Hyperbolic(0.4, 2.0),
    friction.Cubic(0.4, 0.25, 0.7),
    friction.Table([0.1, 0.4, 1.0], [0.42, 0.25, 0.3]),
    friction.LuGre(0.4, 0.25, 0.3, 1e5, 20.0, 0.05),
    friction.Dahl(0.4, 1e5, 2.0),
    friction.ElastoPlastic(0.4, 0.25, 0.3, 1e5, 20.0, 0.05, 0.6),
]
