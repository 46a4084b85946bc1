"""Random systems for the fuzz of physics: each number gives one system, always the same."""

import numpy as np

from squealbox import Contact, Coulomb, Cubic, Hyperbolic, LinearSlope, Ramp, Sinusoid, Stribeck, System


def random_law(rng):
    """Any of the laws with a formula."""
    static = rng.uniform(0.2, 0.7)
    kinetic = static * rng.uniform(0.4, 0.95)
    laws = (
        Coulomb(static), Coulomb(static, kinetic), Stribeck(static, kinetic, rng.uniform(0.05, 0.5)),
        LinearSlope(static, -rng.uniform(0.01, 0.1), 0.05), Hyperbolic(static, rng.uniform(0.1, 2.0)),
        Cubic(static, kinetic, rng.uniform(3.0, 5.0)),
    )  # fmt: skip
    return laws[rng.integers(len(laws))]


def random_speed(rng):
    """At rest, constant, braking, or swinging: slowly or up to twenty times as fast as the system."""
    mean = rng.uniform(0.05, 0.6)
    swing = Sinusoid(rng.choice([0.0, mean]), mean * rng.uniform(0.3, 3.0), 10.0 ** rng.uniform(-1.0, 0.5))
    return (0.0, mean, Ramp(mean, -rng.uniform(0.05, 0.3)), swing, swing)[rng.integers(5)]


def random_normal(rng):
    """Constant, or swinging without ever pulling."""
    mean = rng.uniform(0.5, 2.0)
    swing = Sinusoid(mean, mean * rng.uniform(0.1, 0.95), 10.0 ** rng.uniform(-1.0, 0.5), rng.uniform(0.0, 6.0))
    return (mean, swing)[rng.integers(2)]


def random_system(seed, freedoms=2):
    """A system of up to `freedoms` freedoms and as many contacts and one more, its start and a duration [s]."""
    rng = np.random.default_rng([20261128, seed])
    n = int(rng.integers(1, freedoms + 1))
    frame = np.linalg.qr(rng.standard_normal((n, n)))[0]
    stiffness = frame @ np.diag(rng.uniform(0.5, 8.0, n)) @ frame.T
    mass = np.diag(rng.uniform(0.5, 2.0, n))
    contacts = []
    for _ in range(int(rng.integers(1, n + 1))):
        row = np.eye(n)[rng.integers(n)] if rng.random() < 0.7 else rng.standard_normal(n)
        contacts.append(Contact(np.zeros(n), row, row, random_normal(rng), random_speed(rng), random_law(rng)))
    rows = [tuple(c.t) for c in contacts]
    contacts = [c for i, c in enumerate(contacts) if rows[i] not in rows[:i]]  # two speeds on one motion cannot stick
    if len(contacts) < 2 and rng.random() < 0.3:
        contacts.append(contacts[0])  # two halves of one contact
    load = rng.uniform(-0.5, 0.5, n)
    given = Sinusoid(0.2, rng.uniform(0.1, 1.0), 10.0 ** rng.uniform(-1.0, 0.5)) * load if rng.random() < 0.3 else load
    system = System(mass, rng.uniform(0.0, 0.05) * stiffness, stiffness, given, tuple(contacts))
    return system, (rng.uniform(-1.0, 1.0, n), rng.uniform(-0.5, 0.5, n)), 6.0
