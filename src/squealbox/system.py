"""The equation every minimal brake obeys, its steady sliding state and its linearisation.

    M q'' + C q' + K q = f(t) + sum_c  d_c mu_c(|v_c|) sgn(v_c) N_c
    N_c = N0_c(t) + n_c . q          normal force of contact c                    [N]
    v_c = V_c(t) - t_c . q'          sliding velocity of contact c                [m/s]

A contact senses along n (normal force, N/m) and t (sliding), and acts along d. Linearised about steady sliding q0

    K_eff = K - sum mu sgn(V) d n'            non-symmetric: can flutter
    C_eff = C + sum N_c(q0) mu'(|V|) d t'     indefinite where friction weakens with speed (`memory_rows`: with memory)
              + sum mu N_c(q0) / |V| a a'     where sliding is in a plane: a is the row across it

because v = V - t.q' gives d(mu sgn(v))/dq' = -mu' t' at fixed sgn(v). Every array may carry leading axes, so that one
system can be a whole map of systems: M is (..., n, n), n, d and t are (..., n), N0, V and the law's parameters (...).
"""

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
import scipy

from squealbox import sampled_sliding, sparse_sliding
from squealbox.arguments import Brake, design
from squealbox.contacts import ROWS, Contact, Contacts, dense_rows, numbered, sparse_matrix
from squealbox.factorisation import is_symmetric
from squealbox.loops import Loop, check_loops, folded, near_sliding
from squealbox.matrices import (
    Equilibrium,
    InvalidSystem,
    Linearised,
    array,
    check_mass,
    check_width,
    checked_names,
    coupled,
    felt,
    is_sparse,
)
from squealbox.memory_rows import no_memory, remembering, with_memory
from squealbox.parameters import DataSheet, shown
from squealbox.result import Outcome
from squealbox.schedules import MOVES, Schedule, swinging, value_at
from squealbox.static_deflection import ended, modulo_rigid_motion, solve


class System(DataSheet):
    """The equation of a brake as arrays: M q'' + C q' + K q = load + sum of d mu sgn(v) N over contacts.

    Parameters
    ----------
    M, C, K : shape (..., n, n), mass [kg], damping [N s/m], stiffness [N/m]; C and K may be non-symmetric
    load : f, shape (..., n) [N], or a schedule whose value has that shape
    contacts : the contacts, one by one or as a table :class:`Contacts`
    names, angles : of the degrees of freedom; of those that are rotations [rad], as what ends in ``_turn`` is anyway
    loops : controllers that sense and act (`squealbox.loops`)

    Its parameters have names: ``friction.static``, ``sliding_speed`` and ``normal_force`` of all contacts together, and
    ``contacts.pad.law.static``, ``contacts.2.V`` of one, by its name or number.

    M, C and K may be SciPy sparse arrays, of one system: steady sliding, linearisation, complex modes and their energy
    then stay sparse, and every other analysis says in one sentence that it wants a reduced system.

    Raises `InvalidSystem` when shapes disagree, a number is not finite or M is not symmetric.

    >>> System(M=[[1.0]], C=[[0.1]], K=[[4.0]], load=[0.0], contacts=()).size
    1
    """

    shared: ClassVar = {
        "friction": ("contacts", "law"),
        "sliding_speed": ("contacts", "V"),
        "normal_force": ("contacts", "N0"),
    }
    told: ClassVar = {
        "M": ("kg", "mass"),
        "C": ("N s/m", "damping"),
        "K": ("N/m", "stiffness"),
        "load": ("N", "external force"),
        "names": ("", "degrees of freedom"),
        "angles": ("", "those that are rotations"),
    }

    M: Any
    C: Any
    K: Any
    load: Any = 0.0
    contacts: Any = ()
    names: tuple[str, ...] = ()
    loops: tuple[Loop, ...] = ()
    angles: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        set_ = object.__setattr__
        any_sparse = any(is_sparse(getattr(self, field)) for field in ("M", "C", "K"))
        for field in ("M", "C", "K"):
            set_(self, field, (sparse_matrix if any_sparse else array)(field, getattr(self, field), 2))
        size = self.M.shape[-1]
        for field in ("M", "C", "K"):
            if getattr(self, field).shape[-2:] != (size, size):
                raise InvalidSystem(f"{field} has shape {getattr(self, field).shape}: expected (..., {size}, {size})")
        if not any_sparse:
            check_mass(self.M)
        elif not is_symmetric(self.M):
            raise InvalidSystem("M is not symmetric: expected a symmetric mass matrix")
        if not isinstance(self.load, Schedule):
            if callable(self.load):
                raise InvalidSystem(f"load = {self.load!r}: expected numbers [N] or a schedule")
            load = array("load", self.load, 0)
            set_(self, "load", array("load", np.broadcast_to(load, (size,)) if load.ndim == 0 else load, 1))
        check_width("load", np.asarray(value_at(self.load, 0.0)), size)
        set_(self, "contacts", self._sparse_contacts() if any_sparse else self._dense_contacts())
        set_(self, "names", checked_names(self.names, size))
        set_(self, "angles", tuple(self.angles))
        set_(self, "loops", check_loops(self.loops, self.names, InvalidSystem))

    def _dense_contacts(self) -> tuple[Contact, ...]:
        if not hasattr(self.contacts, "__iter__"):
            raise InvalidSystem(f"contacts is a {type(self.contacts).__name__}: expected several, (contact,) for one")
        contacts = self.contacts.dense() if isinstance(self.contacts, Contacts) else tuple(self.contacts)
        return tuple(dense_rows(_checked_contact(contact, i, self.size)) for i, contact in enumerate(contacts))

    def _sparse_contacts(self) -> Contacts:
        if isinstance(self.contacts, Contacts):
            check_width("contacts.n", self.contacts.n, self.size)
            return self.contacts
        singles = [_checked_contact(contact, i, self.size) for i, contact in enumerate(self.contacts)]
        return Contacts.of(singles, self.size)

    @property
    def is_sparse(self) -> bool:
        """True where M, C and K are sparse and the contacts a table."""
        return isinstance(self.contacts, Contacts)

    @property
    def units(self) -> tuple[str, ...]:
        """Unit of each degree of freedom, m or rad."""
        return tuple("rad" if name in self.angles or name.endswith("_turn") else "m" for name in self.names)

    @property
    def contact_names(self) -> tuple[str, ...]:
        """Name of each contact, "contact 1" and so on where it has none."""
        return numbered([contact.name for contact in self.contacts])

    __str__ = DataSheet.summary

    @property
    def size(self) -> int:
        """Number n of degrees of freedom."""
        return int(self.M.shape[-1])

    @cached_property
    def shape(self) -> tuple[int, ...]:
        """Leading axes: () for one system, the shape of the map for many."""
        if self.is_sparse:
            return ()
        shapes = [self.M.shape[:-2], self.C.shape[:-2], self.K.shape[:-2], np.shape(value_at(self.load, 0.0))[:-1]]
        for contact in self.contacts:
            shapes += [np.shape(getattr(contact, field))[:-1] for field in ("n", "d", "t")]
            shapes += [np.shape(value_at(value, 0.0)) for value in (contact.N0, contact.V)]
            shapes += [np.shape(value) for value in contact.law.coefficients()]
        shapes += [np.shape(value) for loop in self.loops for _, _, value in loop.leaves() if value is not None]
        try:
            return np.broadcast_shapes(*set(shapes))
        except ValueError as error:
            found = ", ".join(str(shape) for shape in sorted(set(shapes)) if shape)
            raise InvalidSystem(f"parameters of shapes {found}: expected shapes that broadcast, one map") from error

    @cached_property
    def rows(self) -> tuple[Any, Any, Any, Any]:
        """n, d, t and normal of all contacts, each (..., contacts, n), for sums that are one matrix product."""
        return self._stacked("n"), self._stacked("d"), self._stacked("t"), self._stacked("normal")

    @cached_property
    def across(self) -> Any:
        """The rows across the sliding direction (..., contacts, n), None where no contact has one."""
        given = any(contact.across is not None for contact in self.contacts)
        return self._stacked("across") if given else None

    def _stacked(self, field: str) -> Any:
        values = [getattr(contact, field) for contact in self.contacts]
        values = [np.zeros(self.size) if value is None else value for value in values]
        return np.stack(np.broadcast_arrays(*values), axis=-2) if values else np.zeros((0, self.size))

    @cached_property
    def alike(self) -> tuple[tuple[Any, tuple[int, ...]], ...]:
        """Each friction law with the contacts that have it: (law, contacts), so that a law is asked once."""
        found: dict[Any, list[int]] = {}
        for i, contact in enumerate(self.contacts):
            found.setdefault(contact.law, []).append(i)
        return tuple((law, tuple(contacts)) for law, contacts in found.items())


DesignOrSystem = Brake | System


def as_system(design_or_system: DesignOrSystem, *, linear: bool = False, plane: bool = False) -> System:
    """The system itself, or what a design's ``system()`` makes.

    A `linear` analysis, about steady sliding, takes sparse matrices and contacts that slide in a plane, a motion that
    knows the `plane` takes these; any other gets an `InvalidSystem` that says why it does not.
    """
    system = _system_of(design_or_system)
    if linear:
        return system
    if system.is_sparse:
        raise InvalidSystem(
            f"the system is sparse, with {system.size} degrees of freedom: this analysis needs dense matrices; "
            "reduce(brake, band=(f1, f2)) makes a small brake that keeps the contacts"
        )
    for i, contact in enumerate(system.contacts):
        if contact.across is not None and not plane:
            raise InvalidSystem(
                f'contacts[{i}].across is given: friction in a plane moves by simulate(..., contact="time-stepping"); '
                "across=None leaves the cross direction out of any other motion"
            )
    return system


def _system_of(given: Any) -> System:
    if isinstance(given, System):
        return folded(given)
    if isinstance(given, type) or not callable(getattr(given, "system", None)):
        raise InvalidSystem(f"{shown(given)}: expected {design(given) or 'a System or a design'}")
    return folded(given.system())


def _checked_contact(contact: object, i: int, size: int) -> Contact:
    if not isinstance(contact, Contact):
        raise InvalidSystem(f"contacts[{i}] = {contact!r}: expected a Contact")
    for field in ROWS:
        if getattr(contact, field) is not None:
            check_width(f"contacts[{i}].{field}", getattr(contact, field), size)
    return contact


def equilibrium(system: DesignOrSystem, time: float = 0.0, start: sparse_sliding.Nearby | None = None) -> Equilibrium:
    """Steady sliding q0 at the load, speeds and normal forces of `time` [s].

    Newton on r(q) = K q - f - sum mu sgn(V) d N(q) [- normal min(N, 0) for unilateral contacts]. Without unilateral
    contacts r is linear in q, because mu depends on V alone, and one step is exact; with them r is piecewise linear and
    each step changes the set of open contacts. A sparse search may begin at the `start` of a similar brake.
    """
    near: System = near_sliding(system if isinstance(system, System) else as_system(system, linear=True), held=True)
    if near.is_sparse:
        return _sparse_equilibrium(near, time, start)
    no_rigid_contact(near, "steady sliding")
    shape, size = near.shape, near.size
    force, speed, mu = _sliding(near, time)
    q = np.zeros((*shape, size))
    base = np.broadcast_to(near.K, (*shape, size, size))
    singular, pushed, converged = (np.zeros(shape, dtype=bool) for _ in range(3))
    floating = np.zeros(shape, dtype=int)
    scale = np.max(np.abs(base), axis=(-1, -2))
    forces = np.max(np.abs(value_at(near.load, time)), axis=-1) + np.max(np.abs(force), axis=-1, initial=0.0)
    linear = not any(contact.unilateral for contact in near.contacts)
    for _ in range(2 + 2 * len(near.contacts) ** 2):
        residual, jacobian = _residual(near, time, q, (force, speed, mu), base)
        step, bad = solve(jacobian, residual)
        if np.any(bad):
            step, bad, floating, pushed = modulo_rigid_motion(jacobian, residual, near.rows[0], forces, step, bad)
        singular |= bad
        q = q - step
        if linear:  # one step is exact
            converged = np.all(np.isfinite(q), axis=-1)
            break
        size_of_step = scale * np.max(np.abs(step), axis=-1)
        converged = size_of_step <= 1e-12 * (scale * np.max(np.abs(q), axis=-1) + forces + 1e-300)
        if np.all(converged | singular):
            break
    sliding = np.all(speed != 0.0, axis=-1)
    exists = converged & ~singular & sliding
    outcome = ended(singular, sliding, converged, speed, pushed)
    return Equilibrium(q, _normal_forces(near, force, q), speed, mu, exists, outcome, np.where(exists, floating, 0))


def linearise(system: DesignOrSystem, time: float = 0.0, start: sparse_sliding.Nearby | None = None) -> Linearised:
    """K_eff and C_eff about steady sliding at `time` [s]; an open contact only takes its stiffness out."""
    system = system if isinstance(system, System) else as_system(system, linear=True)
    if any(loop.sampling is not None for loop in system.loops):
        return sampled_sliding.linearised(system, time, linearise)
    near: System = near_sliding(system)
    state = equilibrium(near, time, start)
    if near.is_sparse:
        return Linearised(near.M, *_sparse_linearised(near, state), state)
    shape, size = near.shape, near.size
    moving = swinging({"load": [near.load], **{x: [getattr(c, x) for c in near.contacts] for x in ("V", "N0")}})
    if moving:  # it moves even at rest: nothing stands still to be linearised about
        said = Outcome("moving", MOVES.format(" and ".join(moving)))
        state = replace(state, exists=np.zeros(shape, dtype=bool), outcome=said)
    damping, stiffness = (np.array(np.broadcast_to(x, (*shape, size, size))) for x in (near.C, near.K))
    if near.contacts:
        n, d, t, reaction = near.rows
        lifts = np.array([contact.unilateral for contact in near.contacts])
        closed = ~lifts | (state.normal_force > 0.0)
        slope = _by_law(near, lambda law, speed: law.direct_slope(speed), state.sliding_speed)
        damping += coupled(d, np.where(closed, state.normal_force * slope, 0.0), t)
        stiffness -= coupled(d, np.where(closed, state.friction * np.sign(state.sliding_speed), 0.0), n)
        across = near.across
        if across is not None:
            with np.errstate(divide="ignore", invalid="ignore"):  # V = 0: there is no steady sliding
                turning = state.friction * state.normal_force / np.abs(state.sliding_speed)
            damping += coupled(across, np.where(closed, turning, 0.0), across)
        if np.any(lifts):
            stiffness -= coupled(reaction, np.where(closed, 0.0, 1.0), n)
    mass = np.broadcast_to(near.M, stiffness.shape)
    if remembering(near.contacts):
        (mass, damping, stiffness), q = with_memory(near.contacts, (mass, damping, stiffness), state, closed)
        state = replace(state, q=q)
    missing = ~state.exists[..., None, None]
    return Linearised(mass, np.where(missing, np.nan, damping), np.where(missing, np.nan, stiffness), state)


def no_rigid_contact(system: System, what: str) -> None:
    """Raise `InvalidSystem` when a contact is rigid: `what` needs its normal force as a function of the state."""
    for i, contact in enumerate(system.contacts):
        if contact.rigid:
            rigid = f"contacts[{i}] is rigid"
            raise InvalidSystem(f"{rigid}: {what} needs N = N0 + n . q; give the contact a stiffness instead")


def contact_state(system: System, time: float | np.ndarray, q: np.ndarray, qd: np.ndarray) -> tuple[Any, Any, Any]:
    """Normal force N [N], sliding velocity v [m/s] and sliding friction force mu sgn(v) N [N] of each contact.

    `q` and `qd` are (..., n) at instants `time` (...); the results are (..., contacts). Where v = 0 the force is 0:
    what a sticking contact carries is known only to the analysis that holds it there.
    """
    no_rigid_contact(system, "a contact's state")
    no_memory(system.contacts, "a contact's state from q and q'")
    normals, speeds, forces = [], [], []
    for contact in system.contacts:
        normal = value_at(contact.N0, time) + np.sum(contact.n * q, axis=-1)
        normal = np.maximum(normal, 0.0) if contact.unilateral else normal
        speed = value_at(contact.V, time) - np.sum(contact.t * qd, axis=-1)
        normals.append(normal)
        speeds.append(speed)
        forces.append(contact.law.mu(speed) * np.sign(speed) * normal)
    empty = np.zeros((*np.shape(q)[:-1], 0))
    return tuple(np.stack(x, axis=-1) if x else empty for x in (normals, speeds, forces))  # type: ignore[return-value]


def _sparse_equilibrium(system: System, time: float, start: sparse_sliding.Nearby | None) -> Equilibrium:
    found = sparse_sliding.sliding_state(system.K, value_at(system.load, time), system.contacts, time, start)
    sliding, singular, settled = np.all(found.speed != 0.0), np.array(found.singular), np.array(found.settled)
    outcome = ended(singular, sliding, settled, found.speed)
    return Equilibrium(found.q, found.normal, found.speed, found.mu, settled & ~singular & sliding, outcome)


def _sparse_linearised(system: System, state: Equilibrium) -> tuple[Any, Any]:
    """C_eff and K_eff; both NaN on the diagonal where there is no steady sliding."""
    no_memory(system.contacts, "a sparse system")
    if not state.exists:
        nothing = scipy.sparse.diags_array(np.full(system.size, np.nan), format="csr")
        return nothing, nothing
    return sparse_sliding.linearised(system.C, system.K, system.contacts, state)


def _sliding(system: System, time: float) -> tuple[Any, Any, Any]:
    shape, count = system.shape, len(system.contacts)
    force, speed = np.zeros((*shape, count)), np.zeros((*shape, count))
    for i, contact in enumerate(system.contacts):
        force[..., i], speed[..., i] = value_at(contact.N0, time), value_at(contact.V, time)
    return force, speed, _by_law(system, lambda law, speed: law.mu(speed), speed)


def _by_law(system: System, ask: Callable[[Any, Any], Any], speed: np.ndarray) -> Any:
    """What `ask`(law, speeds) says of each contact, (..., contacts): contacts of one law together."""
    found = np.zeros(np.shape(speed))
    for law, contacts in system.alike:
        single = len(contacts) == 1 or any(np.ndim(value) for value in law.coefficients())
        for some in contacts if single else (list(contacts),):
            found[..., some] = ask(law, speed[..., some])
    return found


def _residual(system: System, time: float, q: np.ndarray, sliding: tuple[Any, Any, Any], base: Any) -> tuple[Any, Any]:
    force, speed, mu = sliding
    residual = np.einsum("...ij,...j->...i", base, q) - value_at(system.load, time)
    if not system.contacts:
        return residual, np.array(base)
    n, d, _, reaction = system.rows
    lifts = np.array([contact.unilateral for contact in system.contacts])
    normal = force + felt(n, q)
    closed = ~lifts | (normal > 0.0)
    factor = np.where(closed, mu * np.sign(speed), 0.0)
    residual = residual - np.sum((factor * normal)[..., None] * d, axis=-2)
    jacobian = base - coupled(d, factor, n)
    if np.any(lifts):
        residual = residual - np.sum(np.where(closed, 0.0, normal)[..., None] * reaction, axis=-2)
        jacobian = jacobian - coupled(reaction, np.where(closed, 0.0, 1.0), n)
    return residual, jacobian


def _normal_forces(system: System, force: np.ndarray, q: np.ndarray) -> Any:
    if not system.contacts:
        return np.zeros((*system.shape, 0))
    normal = force + felt(system.rows[0], q)
    return np.where([contact.unilateral for contact in system.contacts], np.maximum(normal, 0.0), normal)
