"""Random systems for the fuzz of physics: each number gives one system, always the same."""

import numpy as np

from squealbox import (
    Contact,
    Coulomb,
    Cubic,
    Hyperbolic,
    LinearSlope,
    Ramp,
    Sinusoid,
    Stribeck,
    System,
    friction,
    schedules,
)

FAMILIES, FAMILY = 1000, 25  # from this seed on so many follow each other that share their code and differ in numbers


class Draws:
    """Draws of one system: what it is made of is the same in a family, every size is its own."""

    def __init__(self, key, seed):
        sizes = np.random.default_rng([key, seed])
        kinds = sizes if seed < FAMILIES else np.random.default_rng([key, seed - seed % FAMILY])
        self.integers, self.random, self.choice = kinds.integers, kinds.random, kinds.choice
        self.uniform, self.standard_normal = sizes.uniform, sizes.standard_normal


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
    rng = Draws(20261128, seed)
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


def squealing_system(seed):
    """Up to three freedoms, hardly damped, on belts whose friction falls with speed: many of them squeal."""
    rng = np.random.default_rng([5, seed])
    n, contacts = int(rng.integers(1, 4)), []
    count = int(rng.integers(1, 3))
    frame = np.linalg.qr(rng.standard_normal((n, n)))[0]
    stiffness = frame @ np.diag(rng.uniform(0.5, 6.0, n)) @ frame.T
    for _ in range(count):
        row, static = rng.standard_normal(n), rng.uniform(0.2, 0.6)
        kinetic = static * rng.uniform(0.4, 0.95)
        laws = (
            Stribeck(static, kinetic, rng.uniform(0.1, 0.6)), Hyperbolic(static, rng.uniform(0.1, 1.5)),
            LinearSlope(static, -rng.uniform(0.02, 0.2), 0.05), Cubic(static, kinetic, rng.uniform(2.0, 4.0)),
            Coulomb(static),
        )  # fmt: skip
        sensed = rng.uniform(-1.0, 1.0, n) * rng.choice([0.0, 1.0])
        pressed, speed = rng.uniform(0.5, 2.0), rng.uniform(0.1, 1.0)
        contacts.append(Contact(sensed, row, row, pressed, speed, laws[rng.integers(5)]))
    mass = np.diag(rng.uniform(0.5, 2.0, n))
    return System(mass, stiffness * rng.uniform(0.0, 0.03), stiffness, rng.uniform(-0.3, 0.3, n), tuple(contacts))


def any_law(rng):
    """Any law at all: falling, rising, through measured points, rising from zero, none."""
    if rng.random() < 0.5:
        return random_law(rng)
    static, speed = rng.uniform(0.2, 0.6), rng.uniform(0.05, 0.5)
    speeds = np.concatenate([[0.0], np.cumsum(rng.uniform(0.1, 0.6, 4))])
    laws = (
        Stribeck(static, static * rng.uniform(1.05, 1.6), speed), Stribeck(0.0, static, speed), Coulomb(0.0),
        LinearSlope(static, rng.uniform(0.01, 0.3)), LinearSlope(0.0, rng.uniform(0.05, 0.5)),
        friction.Table(speeds, np.sort(rng.uniform(0.1, 0.6, 5))[::-1]),
        friction.Table(speeds, rng.uniform(0.1, 0.6, 5)), friction.Table(speeds[1:], rng.uniform(0.1, 0.6, 4)),
    )  # fmt: skip
    return laws[rng.integers(len(laws))]


def any_schedule(rng, mean, swing):
    """A value in time within `swing` of its mean: held, ramped, along a table, or oscillating."""
    oscillating = Sinusoid(mean, rng.uniform(0.1, 1.0) * swing, 10.0 ** rng.uniform(-1.0, 0.7), rng.uniform(0.0, 6.0))
    towards = mean + swing * rng.uniform(-1.0, 1.0)
    ramp = Ramp(mean, (towards - mean) / rng.uniform(0.5, 3.0), towards, rng.uniform(0.0, 2.0))
    times = np.cumsum(rng.uniform(0.2, 1.5, 4))
    table = schedules.Table(times, mean + swing * rng.uniform(-1.0, 1.0, 4))
    both = Sinusoid(mean, 0.5 * swing, 10.0 ** rng.uniform(-1.0, 0.5)) + Sinusoid(0.0, 0.5 * swing, 1.7)
    return (mean, mean, oscillating, ramp, table, both)[rng.integers(6)]


ROOMS = ((1, 1), (1, 2), (2, 1), (2, 2), (3, 3), (4, 2), (1, 5), (5, 4), (6, 5))  # each compiles code of its own


def wide_system(seed, rooms=ROOMS):
    """Up to six freedoms and five contacts of every kind: on one motion, at rest, lifting off, rigid, without mass.

    Returns the system, its start, a duration [s] and words for what is in it.
    """
    rng = Draws(20261129, seed)
    n, m = rooms[rng.integers(len(rooms))]
    frame = np.linalg.qr(rng.standard_normal((n, n)))[0]
    stiffness = frame @ np.diag(rng.uniform(0.5, 8.0, n)) @ frame.T
    if rng.random() < 0.2:  # a body free to move
        stiffness = frame @ np.diag([0.0, *rng.uniform(0.5, 8.0, n - 1)]) @ frame.T
    mass = np.diag(rng.uniform(0.5, 2.0, n))
    damping = rng.choice([0.0, 0.05]) * stiffness
    light = n > 1 and rng.random() < 0.15
    bodies = n - 1 if light else n
    words = ["massless"] if light else []
    if light:
        mass[-1, :] = mass[:, -1] = 0.0
        damping[-1, -1] += rng.choice([0.0, 0.7]) if not np.any(damping) else 0.7
        stiffness[-1, -1] += 1.0
    load, contacts = rng.uniform(-0.5, 0.5, n), []
    at_rest = rng.random() < 0.2
    halves = m > 1 and rng.random() < 0.2
    for _ in range(m - halves):
        row = np.zeros(n)
        row[:bodies] = np.eye(bodies)[rng.integers(bodies)] if rng.random() < 0.7 else rng.standard_normal(bodies)
        force = rng.uniform(0.5, 2.0)
        speed = rng.uniform(0.05, 0.6) * rng.choice([-1.0, 1.0, 1.0])
        speed = 0.0 if at_rest or rng.random() < 0.3 else any_schedule(rng, speed, rng.uniform(0.3, 2.0) * abs(speed))
        same = [c for c in contacts if np.array_equal(c.t, row)]
        speed = same[0].V if same else speed  # two speeds on one motion cannot stick
        kind, law = rng.random(), any_law(rng)
        across = [i for i in range(bodies) if row[i] == 0.0]
        if kind < 0.2 and across and law.static_limit > 0.0:  # a spring that may lift off
            words.append("lifting")
            normal, spring = -np.eye(n)[across[0]], rng.uniform(1.0, 8.0)
            stiffness = stiffness + spring * np.outer(normal, normal)
            load = load - force * normal
            contacts.append(Contact(spring * normal, row, row, force, speed, law, unilateral=True, normal=normal))
        elif kind < 0.4 and across and not any(c.rigid for c in contacts):
            words.append("rigid")
            normal = np.zeros(n)
            normal[across[-1]] = rng.choice([-1.0, 1.0])
            gap, back = rng.choice([0.0, rng.uniform(0.05, 0.6)]), rng.choice([0.0, 0.0, 0.4, 1.0])
            contacts.append(Contact(np.zeros(n), row, row, 0.0, speed, law, unilateral=True, normal=normal, rigid=True,
                                    gap=gap, restitution=back))  # fmt: skip
        else:
            given = any_schedule(rng, force, 0.95 * force)
            sensed = 0.1 * force * rng.standard_normal(n) / n if rng.random() < 0.3 else np.zeros(n)
            force_row = row if rng.random() < 0.85 or same else row * rng.uniform(0.5, 1.5)
            contacts.append(Contact(sensed, force_row, row, given, speed, law))
    if halves:
        words.append("halves")
        contacts.append(contacts[-1] if not contacts[-1].rigid else contacts[0])
    start = rng.uniform(-1.0, 1.0, n), rng.uniform(-0.5, 0.5, n)
    for c in contacts:
        if c.rigid and float(c.gap - c.normal @ start[0]) < 0.0:
            start[0][np.flatnonzero(c.normal)[0]] = c.gap * np.sum(c.normal) - 0.3 * np.sum(c.normal) * rng.integers(2)
    given = Sinusoid(0.2, rng.uniform(0.1, 1.0), 10.0 ** rng.uniform(-1.0, 0.5)) * load
    system = System(mass, damping, stiffness, given if rng.random() < 0.2 else load, tuple(contacts))
    return system, start, 4.0, words
