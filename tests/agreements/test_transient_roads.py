"""Two roads, one answer: compiled = plain, transient = eigenvalue, any method, any output times, audit = zero."""

import importlib
from types import SimpleNamespace

import numpy as np
import pytest

from small_systems import METHODS, READINGS, block_on_belt, drum, two_blocks_on_belt, two_masses
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
    simulate,
)
from squealbox.stability import complex_modes
from squealbox.system import equilibrium, linearise
from squealbox.transient import _engine

MEASURED = friction.Table([0.0, 0.1, 0.4, 1.0], [0.42, 0.35, 0.25, 0.28])
LAWS = [Coulomb(0.4, 0.25), LinearSlope(0.4, -0.1), LinearSlope(0.4, -0.5, 0.3), Stribeck(0.4, 0.25, 0.1),
        Hyperbolic(0.4, 2.0), Cubic(0.4, 0.25, 0.5), MEASURED]  # fmt: skip
SPEEDS = [0.1, Ramp(0.3, -0.2), Sinusoid(0.2, 0.15, 0.4), schedules.Table([0.0, 0.7, 1.5], [0.3, 0.05, 0.2])]


@pytest.fixture
def in_plain_python(monkeypatch):
    """Runs of the same generated file without the compiler."""
    kernel = _engine.kernel

    def plain(events, own=()):
        march = kernel(events, plain=True, own=own)

        def run(*arguments):
            records = [SimpleNamespace(**{name: a[name] for name in a.dtype.names}) for a in arguments[:3]]
            with np.errstate(all="ignore"):  # compiled code divides as NumPy does, without a word
                return march(*records, *arguments[3:])

        return run

    def simulated(*arguments, **options):
        with monkeypatch.context() as patch:
            patch.setattr(_engine, "kernel", plain)
            return simulate(*arguments, **options)

    return simulated


def assert_same(one, other, tolerance=1e-12):
    """The same motion at requested instants, up to round-off: fused multiplications differ in the last digit."""
    assert one.outcome == other.outcome
    assert (one.steps, one.rejected) == (other.steps, other.rejected)
    assert one.event_mode.tolist() == other.event_mode.tolist()
    for name in ("t", "q", "qd", "normal_force", "sliding_velocity", "friction_force", "work_friction", "event_time"):
        first, second = getattr(one, name), getattr(other, name)
        assert np.max(np.abs(first - second), initial=0.0) <= tolerance * max(1.0, np.max(np.abs(first), initial=0.0))
    assert np.array_equal(one.mode, other.mode)


@pytest.mark.parametrize("contact", ["exact", "raw", "smooth", "tanh"])
@pytest.mark.parametrize("method", METHODS)
def test_compiled_is_plain_for_every_scheme_and_method(contact, method, in_plain_python):
    options = {"method": method, "contact": contact, "rtol": 1e-4, "width": 0.05, "times": 6}
    system, start = two_blocks_on_belt(), ([0.3, -0.1], [0.1, 0.0])
    if contact != "exact":  # one reversal of each sense, but of plain sgn none: stepping over it blows round-off up
        start = ([1.0, -1.0], [-0.3, 1.2] if contact == "raw" else [0.3, 0.2])
    duration = 3.0 if contact == "exact" else 0.6
    assert_same(simulate(system, duration, start, **options), in_plain_python(system, duration, start, **options))


@pytest.mark.parametrize("contact", ["exact", "raw"])
@pytest.mark.parametrize("law", LAWS, ids=lambda law: type(law).__name__)
def test_compiled_is_plain_for_every_law(law, contact, in_plain_python):
    system, start = block_on_belt(law, 0.1), ([0.3], [-0.3]) if contact == "exact" else ([0.0], [1.0])
    duration = 2.0 if contact == "exact" else 0.6  # plain sgn up to the first reversal
    options = {"contact": contact, "rtol": 1e-5, "method": "dormand-prince", "times": 9}
    assert_same(simulate(system, duration, start, **options), in_plain_python(system, duration, start, **options))


@pytest.mark.parametrize("speed", SPEEDS, ids=lambda speed: type(speed).__name__)
def test_compiled_is_plain_for_every_schedule(speed, in_plain_python):
    system = block_on_belt(Coulomb(0.4, 0.25), speed, normal=Ramp(1.0, 0.3, 1.2), load=Sinusoid(0.1, 0.1, 0.3) * [1.0])
    options = {"rtol": 1e-6, "times": 9}
    one = simulate(system, 2.0, ([0.1], [0.2]), **options)
    assert_same(one, in_plain_python(system, 2.0, ([0.1], [0.2]), **options))


def test_another_law_is_not_the_same_run(in_plain_python):
    with pytest.raises(AssertionError):
        assert_same(
            simulate(block_on_belt(Coulomb(0.4, 0.25), 0.1), 3.0, times=9),
            in_plain_python(block_on_belt(Coulomb(0.4, 0.2501), 0.1), 3.0, times=9),
        )


def single_mode(samples, spacing):
    """(growth rate, angular frequency) of one damped oscillation by linear prediction: no eigenvector is used."""
    before, at, after = (samples[i : len(samples) - 2 + i].ravel() for i in range(3))
    (a, b), *_ = np.linalg.lstsq(np.column_stack([at, before]), after, rcond=None)
    root = np.log(np.roots([1.0, -a, -b]).astype(complex))
    return root[0].real / spacing, abs(root[0].imag) / spacing


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("friction_coefficient", [0.1, 0.3, 0.45])
def test_linearised_drum_has_the_growth_rate_of_its_eigenvalue(friction_coefficient, method):
    # issue 2: to 1e-4 relative. Both modes in turn, each started on its own.
    matrices = linearise(drum(friction_coefficient))
    linear = System(matrices.M, matrices.C, matrices.K)
    modes = complex_modes(linear)
    for eigenvalue, vector in upper_modes(modes):
        start = (np.real(vector), np.real(eigenvalue * vector))
        rtol = 1e-9 if method == "bogacki-shampine" else 1e-10
        motion = simulate(linear, 2e-3, start, times=201, method=method, rtol=rtol, atol=1e-12)
        growth, frequency = single_mode(motion.q, 1e-5)
        assert growth == pytest.approx(eigenvalue.real, rel=1e-4)
        assert frequency == pytest.approx(eigenvalue.imag, rel=1e-6)


def upper_modes(modes):
    """(eigenvalue, right mode) of each oscillation."""
    keep = np.flatnonzero(modes.eigenvalues.imag > 0.0)
    return [(modes.eigenvalues[i], modes.right[:, i]) for i in keep]


@pytest.mark.parametrize("reading", READINGS)
def test_small_perturbation_of_sliding_has_the_growth_rate_of_the_eigenvalue(reading):
    # the nonlinear drum: a perturbation of 1e-5 of the sliding speed; what is quadratic in it is below 1e-4
    system = drum(0.3, reading)
    steady = equilibrium(system).q
    for eigenvalue, vector in upper_modes(complex_modes(system)):
        vector = 2e-6 * vector / np.max(np.abs(eigenvalue * vector))
        start = (steady + np.real(vector), np.real(eigenvalue * vector))
        motion = simulate(system, 1e-3, start, times=101, rtol=1e-13, atol=1e-17)
        assert motion.event_time.size == 0
        growth, frequency = single_mode(motion.q - steady, 1e-5)
        assert growth == pytest.approx(eigenvalue.real, rel=1e-4)
        assert frequency == pytest.approx(eigenvalue.imag, rel=1e-6)


def test_a_wrong_slope_is_seen_in_the_growth_rate():
    eigenvalue = upper_modes(complex_modes(drum(0.3, slope=-0.051)))[0][0]
    other = upper_modes(complex_modes(drum(0.3, slope=-0.05)))[0][0]
    assert abs(eigenvalue.real / other.real - 1.0) > 1e-4


@pytest.mark.parametrize("reading", READINGS)
@pytest.mark.parametrize("preload", [None, 1000.0])
def test_all_methods_agree_on_the_drum(reading, preload):
    # the order-3 method carries its own tolerance; errors grow with the motion, by about 100 times over this run
    system = drum(0.44, reading, preload=preload)
    reference = simulate(system, 0.01, rtol=1e-13, times=3)
    assert reference.outcome == "completed"
    scale = np.max(np.abs(reference.q))
    for method, rtol, tolerance in (
        ("bogacki-shampine", 1e-9, 1e-6),
        ("dormand-prince", 1e-11, 1e-8),
        ("tsitouras", 1e-11, 1e-8),
        ("dormand-prince-8", 1e-11, 1e-8),
    ):
        motion = simulate(system, 0.01, rtol=rtol, times=3, method=method)
        assert motion.outcome == "completed"
        assert np.max(np.abs(motion.q[-1] - reference.q[-1])) < tolerance * scale


@pytest.mark.parametrize(("contact", "tolerance"), [("exact", 1e-8), ("smooth", 1e-7), ("tanh", 1e-7)])
@pytest.mark.parametrize("method", METHODS)
def test_energy_audit_closes(contact, tolerance, method):
    # the energy integrals run along with the motion at its steps, so they close to a few hundred times rtol
    rtol = 1e-8 if method == "bogacki-shampine" else 1e-10
    motion = simulate(
        two_blocks_on_belt(), 20.0, ([0.3, -0.1], [0.1, 0.0]), contact=contact, rtol=rtol, method=method, width=0.02
    )
    assert motion.outcome == "completed"
    assert motion.energy.relative_residual < tolerance * (10.0 if method == "bogacki-shampine" else 1.0)


def test_energy_audit_of_plain_sgn_closes_while_nothing_sticks():
    motion = simulate(drum(0.3), 0.01, contact="raw", rtol=1e-8, method="dormand-prince")
    assert motion.outcome == "completed"
    assert motion.energy.relative_residual < 1e-6


@pytest.mark.parametrize("reading", READINGS)
@pytest.mark.parametrize("preload", [None, 1000.0])
def test_energy_audit_of_the_drum(reading, preload):
    motion = simulate(drum(0.44, reading, preload=preload), 0.01, rtol=1e-10)
    assert motion.outcome == "completed"
    assert motion.energy.relative_residual < 1e-8  # issue 3


def test_energy_audit_with_schedules_and_a_skew_stiffness():
    system = two_blocks_on_belt(speed=Ramp(0.3, -0.05)).replace(
        {"K": two_masses().K, "load": Sinusoid(0.0, 0.3, 0.2) * [1, 2]}
    )
    motion = simulate(system, 12.0, rtol=1e-11)
    audit = motion.energy
    assert np.max(np.abs(audit.circulation)) > 1e-3
    assert audit.relative_residual < 1e-9


def test_an_audit_with_a_missing_term_does_not_close():
    motion = simulate(two_blocks_on_belt(damping=0.1), 20.0, ([0.3, -0.1], [0.1, 0.0]))
    audit = motion.energy
    assert np.max(np.abs(audit.residual - audit.dissipated)) > 1e3 * np.max(np.abs(audit.residual))


@pytest.mark.parametrize("contact", ["exact", "raw", "smooth"])
@pytest.mark.parametrize("method", METHODS)
def test_output_times_change_nothing(contact, method):
    options = {"contact": contact, "method": method, "rtol": 1e-6, "width": 0.02}
    every = simulate(drum(0.3), 0.005, **options)
    few = simulate(drum(0.3), 0.005, times=[0.001, 0.005], **options)
    many = simulate(drum(0.3), 0.005, times=1001, **options)
    assert every.outcome == "completed"
    for other in (few, many):
        # the same steps to the last bit; a requested instant goes through the dense output, which rounds once more
        assert other.q[-1] == pytest.approx(every.q[-1], rel=1e-14)
        assert other.qd[-1] == pytest.approx(every.qd[-1], rel=1e-13)
        assert np.array_equal(other.event_time, every.event_time)
        assert (other.steps, other.rejected) == (every.steps, every.rejected)
    assert np.array_equal(few.q[1], many.q[-1])
    assert np.array_equal(few.q[0], many.q[200])


@pytest.mark.parametrize("method", METHODS)
def test_output_between_steps_is_as_good_as_at_steps(method):
    # dense output against a run at a tenth of the tolerance steps; one order lower, so a looser bound
    system, start = drum(0.44, "eq3_signed"), None
    reference = simulate(system, 2e-3, start, times=401, rtol=1e-13)
    motion = simulate(system, 2e-3, start, times=401, rtol=1e-9, method=method)
    assert np.max(np.abs(motion.q - reference.q)) < 1e-6 * np.max(np.abs(reference.q))


def test_a_run_in_small_budgets_is_the_same_run(monkeypatch):
    module = importlib.import_module("squealbox.transient.legs")
    whole = simulate(two_blocks_on_belt(), 6.0, ([0.3, -0.1], [0.1, 0.0]))
    monkeypatch.setattr(module, "BUDGET", (3, 3))
    pieces = simulate(two_blocks_on_belt(), 6.0, ([0.3, -0.1], [0.1, 0.0]))
    assert np.array_equal(whole.q, pieces.q)
    assert whole.evaluations == pieces.evaluations


def test_reference_by_time_stepping():
    # issue 3: two contacts that stick alternately and together, against Moreau's steps, an order-1 method
    system, start = two_blocks_on_belt(), ([0.3, -0.1], [0.1, 0.0])
    exact = simulate(system, 12.0, start, times=25, rtol=1e-11)
    assert {tuple(modes) for modes in np.sign(exact.mode).tolist()} >= {(0, 0), (0, 1), (1, 0), (1, 1)}
    errors = []
    for step in (4e-4, 2e-4, 1e-4):
        stepped = simulate(system, 12.0, start, times=25, contact="time-stepping", step=step)
        errors.append(np.max(np.abs(stepped.q - exact.q)))
    assert errors[-1] < 1e-3
    assert errors[0] / errors[-1] == pytest.approx(4.0, rel=0.5)


def chain(blocks):
    """Blocks in a row on one belt, joined to the next and to the frame by springs; their loads differ a little."""
    ends = np.arange(blocks)
    stiffness = np.diag(np.full(blocks, 1.6)) - 0.4 * (np.eye(blocks, k=1) + np.eye(blocks, k=-1))
    contacts = tuple(
        Contact(np.zeros(blocks), row, row, N0=1.0 + 0.1 * (i % 4), V=0.1, law=Coulomb(0.4, 0.25))
        for i, row in zip(ends, np.eye(blocks), strict=True)
    )
    return System(np.eye(blocks), 0.02 * np.eye(blocks), stiffness, 0.0, contacts)


def test_a_chain_of_blocks_by_time_stepping():
    # issue 3: an order-1 method with tiny steps against exact events, for contacts coupled through their blocks
    system, start = chain(4), ([0.3, -0.1, 0.2, 0.0], [0.1, 0.0, -0.1, 0.05])
    exact = simulate(system, 8.0, start, times=17, rtol=1e-11)
    assert exact.outcome == "completed"
    assert len(exact.event_time) >= 8
    errors = []
    for step in (4e-4, 1e-4):
        stepped = simulate(system, 8.0, start, times=17, contact="time-stepping", step=step)
        errors.append(np.max(np.abs(stepped.q - exact.q)))
    assert errors[1] < 1e-3
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.6)


def test_time_stepping_costs_in_proportion_to_the_contacts():
    # issue 3: counted, not timed. Neighbours only share a spring, so the sweeps do not grow with the chain, and the
    # rows a sweep walks through hold as many numbers for each contact however many contacts there are.
    from squealbox.transient import moreau, packing
    from squealbox.transient.methods import Method

    numbers = []
    for blocks in (25, 50, 100):
        system = chain(blocks)
        z = moreau._stepping(system, packing.pack(system, Method(), 0, 1.0, True))
        numbers.append(sum(getattr(z, f"{name}_value").size for name in ("mk", "mc", "n", "t", "d", "md", "mw")))
        run = simulate(system, 1.0, contact="time-stepping", step=2e-3)
        assert run.outcome == "completed"
    assert numbers[1] / numbers[0] == pytest.approx(2.0, rel=0.05)
    assert numbers[2] / numbers[1] == pytest.approx(2.0, rel=0.05)
