"""Random systems of one shape, which share a compiled step: single runs by two engines, and ensembles, agree."""

import numpy as np
import pytest

from squealbox import Contact, Coulomb, Ramp, Sinusoid, System, simulate, simulate_ensemble

COUNT, DURATION = 50, 25.0


def braking(rng):
    """Two blocks' worth of matrices and two contacts; a belt that brakes to standstill, a load on it that swings."""

    def draw():
        roots = rng.uniform(-1.0, 1.0, (2, 2))
        stiffness = 3.0 * roots @ roots.T + rng.uniform(0.5, 6.0) * np.eye(2)
        static = rng.uniform(0.2, 0.6)
        law = Coulomb(static, static * rng.uniform(0.3, 1.0))
        normal, braked = rng.uniform(0.5, 3.0), rng.uniform(0.05, 0.6)
        rows = rng.uniform(-1.0, 1.0, (2, 2))
        speeds = (Ramp(braked, -rng.uniform(0.02, 0.3), 0.0, rng.uniform(0.0, 5.0)), rng.uniform(0.05, 0.6))
        presses = (Sinusoid(normal, 0.5 * normal, rng.uniform(0.05, 0.5)), 0.7 * normal)
        contacts = tuple(
            Contact([0.0, 0.0], row, row, N0, V, law) for row, N0, V in zip(rows, presses, speeds, strict=True)
        )
        return System(np.diag(rng.uniform(0.5, 2.0, 2)), 0.03 * stiffness, stiffness, [0.0, 0.0], contacts)

    return draw


def stacked(systems):
    """The systems as one with a leading axis."""
    first = systems[0].contacts

    def together(kind, parts):
        names = [name for name in parts[0].parameters() if getattr(parts[0], name) is not None]
        return kind(**{name: np.array([getattr(part, name) for part in parts]) for name in names})

    contacts = []
    for c in range(len(first)):
        mine = [system.contacts[c] for system in systems]
        speeds, presses = [each.V for each in mine], [each.N0 for each in mine]
        V = together(Ramp, speeds) if isinstance(speeds[0], Ramp) else np.array(speeds)
        N0 = together(Sinusoid, presses) if isinstance(presses[0], Sinusoid) else np.array(presses)
        rows = np.array([each.t for each in mine])
        contacts.append(Contact(0.0 * rows, rows, rows, N0, V, together(Coulomb, [each.law for each in mine])))
    matrices = (np.array([getattr(system, name) for system in systems]) for name in "MCK")
    return System(*matrices, np.zeros((len(systems), 2)), tuple(contacts))


def test_brakes_that_stop():
    draw = braking(np.random.default_rng(11))
    systems = [draw() for _ in range(COUNT)]
    exact = [simulate(system, DURATION, method="dormand-prince-8", rtol=1e-11) for system in systems]
    assert {str(each.outcome) for each in exact} == {"completed"}
    events = [len(each.event_time) for each in exact]
    ends = np.array([each.q[-1] for each in exact])
    assert np.sum(events) > 2 * COUNT
    for system, known in zip(systems, exact, strict=True):
        motion = simulate(system, DURATION)
        assert motion.event_time == pytest.approx(known.event_time, abs=1e-6)
        assert motion.q[-1] == pytest.approx(known.q[-1], abs=1e-7)
    for method, rtol in ((None, 1e-9), ("dormand-prince", 1e-8), ("bogacki-shampine", 1e-7)):
        found = simulate_ensemble(stacked(systems), duration=DURATION, method=method, rtol=rtol)
        assert found.events.tolist() == events
        assert found.q == pytest.approx(ends, abs=1e-4)
