"""The equation every minimal brake obeys, its steady sliding state and its linearisation.

    M q'' + C q' + K q = f(t) + sum_c  d_c mu_c(|v_c|) sgn(v_c) N_c
    N_c = N0_c(t) + n_c . q          normal force of contact c                    [N]
    v_c = V_c(t) - t_c . q'          sliding velocity of contact c                [m/s]

A contact senses along n (normal force, N/m) and t (sliding), and acts along d. Linearised about steady sliding q0

    K_eff = K - sum mu sgn(V) d n'            non-symmetric: can flutter
    C_eff = C + sum N_c(q0) mu'(|V|) d t'     indefinite where friction weakens with speed

because v = V - t.q' gives d(mu sgn(v))/dq' = -mu' t' at fixed sgn(v). Every array may carry leading axes, so that one
system can be a whole map of systems: M is (..., n, n), n, d and t are (..., n), N0, V and the law's parameters (...).
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from squealbox.friction import FrictionLaw
from squealbox.parameters import DataSheet
from squealbox.result import COMPLETED, Outcome
from squealbox.schedules import Schedule, value_at


class InvalidSystem(ValueError):
    """Matrices, vectors or contacts do not make a system; the message names array, shape and what was expected."""


class Contact(DataSheet):
    """One frictional contact: a row of the table above.

    Parameters
    ----------
    n : shape (..., n), [N/m] normal force per displacement
    d : shape (..., n), [-] direction in which friction acts on the degrees of freedom
    t : shape (..., n), [-] sliding velocity per velocity: v = V - t . q'
    N0 : [N] normal force at q = 0; number, shape (...), or schedule
    V : [m/s] sliding speed at rest; number, shape (...), or schedule
    law : friction law
    name : what tables and plots call it
    unilateral : True when the contact opens instead of pulling: N = max(N0 + n.q, 0). K and load then hold the
        closed contact's normal reaction ``-normal * N``, which is taken out while the contact is open.
    normal : shape (..., n), [-] direction of that reaction; needed for a unilateral contact
    rigid : True for a unilateral contact without a spring: its gap ``gap - normal . q`` never turns negative, and its
        normal force, the reaction ``-normal * N``, is what keeps it so. n and N0 are 0 then.
    gap : [m] gap of a rigid contact at q = 0
    restitution : [-] Newton's coefficient e in [0, 1] of a rigid contact that lands: it leaves at e times the speed
    """

    n: Any
    d: Any
    t: Any
    N0: Any
    V: Any
    law: FrictionLaw
    name: str = ""
    unilateral: bool = False
    normal: Any = None
    rigid: bool = False
    gap: float = 0.0
    restitution: float = 0.0

    def __post_init__(self) -> None:
        for field in ("n", "d", "t", "normal"):
            if getattr(self, field) is not None:
                object.__setattr__(self, field, _array(f"contact {self.name}.{field}", getattr(self, field), 1))
        for field in ("N0", "V"):
            if not isinstance(getattr(self, field), Schedule):
                object.__setattr__(self, field, _array(f"contact {self.name}.{field}", getattr(self, field), 0))
        if not isinstance(self.law, FrictionLaw):
            raise InvalidSystem(f"contact {self.name}.law = {self.law!r}: expected a friction law")
        if self.unilateral and self.normal is None:
            raise InvalidSystem(f"contact {self.name}.normal is missing: a unilateral contact needs its direction")
        self._check_rigid()

    def _check_rigid(self) -> None:
        name = f"contact {self.name}"
        for field, low, high in (("gap", -np.inf, np.inf), ("restitution", 0.0, 1.0)):
            value = getattr(self, field)
            if np.ndim(value) != 0 or not np.isfinite(value) or not low <= value <= high:
                expected = "a number in [0, 1]" if field == "restitution" else "a finite number of metres"
                raise InvalidSystem(f"{name}.{field} = {value!r}: expected {expected}")
            if value != 0.0 and not self.rigid:
                raise InvalidSystem(f"{name}.{field} = {value!r}: only a rigid contact has one; give it rigid=True")
        if not self.rigid:
            return
        if self.normal is None or self.normal.ndim != 1 or not np.any(self.normal):
            raise InvalidSystem(f"{name}.normal = {self.normal!r}: a rigid contact needs its direction, shape (n,)")
        if not self.unilateral:
            raise InvalidSystem(
                f"{name}.unilateral = {self.unilateral!r}: a rigid contact can only press; expected True"
            )
        if np.any(self.n) or isinstance(self.N0, Schedule) or np.any(self.N0):
            raise InvalidSystem(
                f"{name}: a rigid contact's normal force follows from the motion; expected n = 0, N0 = 0"
            )


class System(DataSheet):
    """The equation at the head of this module, as arrays.

    Parameters
    ----------
    M, C, K : shape (..., n, n), mass [kg], damping [N s/m], stiffness [N/m]; C and K may be non-symmetric
    load : f, shape (..., n) [N], or a schedule whose value has that shape
    contacts : the contacts
    names : names of the degrees of freedom

    Raises `InvalidSystem` when shapes disagree, a number is not finite or M is not symmetric.

    >>> System(M=[[1.0]], C=[[0.1]], K=[[4.0]], load=[0.0], contacts=()).size
    1
    """

    M: Any
    C: Any
    K: Any
    load: Any = 0.0
    contacts: tuple[Contact, ...] = ()
    names: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        set_ = object.__setattr__
        for field in ("M", "C", "K"):
            set_(self, field, _array(field, getattr(self, field), 2))
        size = self.M.shape[-1]
        for field in ("M", "C", "K"):
            if getattr(self, field).shape[-2:] != (size, size):
                raise InvalidSystem(f"{field} has shape {getattr(self, field).shape}: expected (..., {size}, {size})")
        if not np.allclose(self.M, np.swapaxes(self.M, -1, -2)):
            raise InvalidSystem("M is not symmetric: expected a symmetric mass matrix")
        if not isinstance(self.load, Schedule):
            load = _array("load", self.load, 0)
            set_(self, "load", _array("load", np.broadcast_to(load, (size,)) if load.ndim == 0 else load, 1))
        _check_width("load", np.asarray(value_at(self.load, 0.0)), size)
        set_(self, "contacts", tuple(self.contacts))
        set_(self, "names", tuple(self.names) or tuple(f"q{i + 1}" for i in range(size)))
        for i, contact in enumerate(self.contacts):
            if not isinstance(contact, Contact):
                raise InvalidSystem(f"contacts[{i}] = {contact!r}: expected a Contact")
            for field in ("n", "d", "t", "normal"):
                if getattr(contact, field) is not None:
                    _check_width(f"contacts[{i}].{field}", getattr(contact, field), size)

    @property
    def size(self) -> int:
        """Number n of degrees of freedom."""
        return int(self.M.shape[-1])

    @property
    def shape(self) -> tuple[int, ...]:
        """Leading axes: () for one system, the shape of the map for many."""
        shapes = [self.M.shape[:-2], self.C.shape[:-2], self.K.shape[:-2], np.shape(value_at(self.load, 0.0))[:-1]]
        for contact in self.contacts:
            shapes += [np.shape(getattr(contact, field))[:-1] for field in ("n", "d", "t")]
            shapes += [np.shape(value_at(value, 0.0)) for value in (contact.N0, contact.V)]
            shapes += [np.shape(value) for value in contact.law.coefficients()]
        return np.broadcast_shapes(*shapes)


@dataclass(frozen=True)
class Equilibrium:
    """Steady sliding: displacements and contact states, or why there is none.

    q (..., n) [m]; normal_force, sliding_speed and friction (..., contacts) in N, m/s and -; exists (...) bool;
    outcome "completed", "singular" (K_eff cannot be solved), "no_sliding" (a contact has V = 0, so any force up to the
    static limit balances) or "no_convergence"; with leading axes the outcome names the worst entry.
    """

    q: Any
    normal_force: Any
    sliding_speed: Any
    friction: Any
    exists: Any
    outcome: Outcome


@dataclass(frozen=True)
class Linearised:
    """M, C_eff, K_eff, each (..., n, n), about an equilibrium; NaN where there is none."""

    M: Any
    C: Any
    K: Any
    equilibrium: Equilibrium


def as_system(design_or_system: Any) -> System:
    """The system itself, or what a design's ``system()`` makes."""
    return design_or_system if isinstance(design_or_system, System) else design_or_system.system()


def equilibrium(system: System, time: float = 0.0) -> Equilibrium:
    """Steady sliding q0 at the load, speeds and normal forces of `time` [s].

    Newton on r(q) = K q - f - sum mu sgn(V) d N(q) [- normal min(N, 0) for unilateral contacts]. Without unilateral
    contacts r is linear in q, because mu depends on V alone, and one step is exact; with them r is piecewise linear and
    each step changes the set of open contacts, so the number of steps is bounded by that of the contacts' states.
    """
    no_rigid_contact(system, "steady sliding")
    shape, size = system.shape, system.size
    force, speed, mu = _sliding(system, time)
    q = np.zeros((*shape, size))
    base = np.broadcast_to(system.K, (*shape, size, size))
    singular = np.zeros(shape, dtype=bool)
    converged = np.zeros(shape, dtype=bool)
    scale = np.max(np.abs(base), axis=(-1, -2))
    forces = np.max(np.abs(value_at(system.load, time)), axis=-1) + np.max(np.abs(force), axis=-1, initial=0.0)
    linear = not any(contact.unilateral for contact in system.contacts)
    for _ in range(2 + 2 * len(system.contacts) ** 2):
        residual, jacobian = _residual(system, time, q, force, speed, mu, base)
        step, bad = _solve(jacobian, residual)
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
    normal = _normal_forces(system, time, q)
    return Equilibrium(q, normal, speed, mu, exists, _equilibrium_outcome(singular, sliding, converged, speed))


def linearise(system: System, time: float = 0.0) -> Linearised:
    """K_eff and C_eff about steady sliding at `time` [s]; an open contact only takes its stiffness out."""
    state = equilibrium(system, time)
    shape, size = system.shape, system.size
    damping = np.array(np.broadcast_to(system.C, (*shape, size, size)))
    stiffness = np.array(np.broadcast_to(system.K, (*shape, size, size)))
    for i, contact in enumerate(system.contacts):
        normal, speed, mu = (a[..., i, None, None] for a in (state.normal_force, state.sliding_speed, state.friction))
        closed = (normal > 0.0) if contact.unilateral else True
        slope = np.asarray(contact.law.slope_at(speed[..., 0, 0]))[..., None, None]
        damping += np.where(closed, normal * slope, 0.0) * _outer(contact.d, contact.t)
        stiffness -= np.where(closed, mu * np.sign(speed), 0.0) * _outer(contact.d, contact.n)
        if contact.unilateral:
            stiffness -= np.where(closed, 0.0, 1.0) * _outer(contact.normal, contact.n)
    missing = ~state.exists[..., None, None]
    mass = np.broadcast_to(system.M, stiffness.shape)
    return Linearised(mass, np.where(missing, np.nan, damping), np.where(missing, np.nan, stiffness), state)


def no_rigid_contact(system: System, what: str) -> None:
    """Raise `InvalidSystem` when a contact is rigid: `what` needs its normal force as a function of the state."""
    for i, contact in enumerate(system.contacts):
        if contact.rigid:
            raise InvalidSystem(
                f"contacts[{i}] is rigid: {what} needs N = N0 + n . q; give the contact a stiffness instead"
            )


def contact_state(system: System, time: Any, q: Any, qd: Any) -> tuple[Any, Any, Any]:
    """Normal force N [N], sliding velocity v [m/s] and sliding friction force mu sgn(v) N [N] of each contact.

    `q` and `qd` are (..., n) at instants `time` (...); the results are (..., contacts). Where v = 0 the force is 0:
    what a sticking contact carries is known only to the analysis that holds it there.
    """
    no_rigid_contact(system, "a contact's state")
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


def mechanical_energy(system: System, q: Any, qd: Any) -> Any:
    """Kinetic plus strain energy [J], 1/2 q'.M q' + 1/2 q.Ks q with Ks the symmetric part of K; shape (...)."""
    symmetric = 0.5 * (system.K + np.swapaxes(system.K, -1, -2))
    return 0.5 * _form(qd, system.M, qd) + 0.5 * _form(q, symmetric, q)


def power_of_friction(system: System, time: Any, q: Any, qd: Any) -> Any:
    """Power [W] each contact feeds into the vibration, (d.q') mu sgn(v) N, shape (..., contacts)."""
    _, _, forces = contact_state(system, time, q, qd)
    along = [np.sum(contact.d * qd, axis=-1) for contact in system.contacts]
    return np.stack(along, axis=-1) * forces if along else forces


def power_dissipated(system: System, qd: Any) -> Any:
    """Power [W] the damping takes out, q'.C q', shape (...)."""
    return _form(qd, system.C, qd)


def power_of_circulation(system: System, q: Any, qd: Any) -> Any:
    """Power [W] fed in by the skew part Ka of the stiffness itself, -q'.Ka q, shape (...); 0 for a symmetric K."""
    skew = 0.5 * (system.K - np.swapaxes(system.K, -1, -2))
    return -_form(qd, skew, q)


def power_of_load(system: System, time: Any, qd: Any) -> Any:
    """Power [W] of the load, q'.f(t), shape (...)."""
    if isinstance(system.load, Schedule):
        load = np.stack([np.asarray(system.load.value(t)) for t in np.ravel(time)])
        load = load.reshape(*np.shape(time), -1)
    else:
        load = system.load
    return np.sum(load * qd, axis=-1)


def _sliding(system: System, time: float) -> tuple[Any, Any, Any]:
    shape = system.shape
    force = [np.broadcast_to(value_at(c.N0, time), shape) for c in system.contacts]
    speed = [np.broadcast_to(value_at(c.V, time), shape) for c in system.contacts]
    mu = [np.broadcast_to(c.law.mu(v), shape) for c, v in zip(system.contacts, speed, strict=True)]
    empty = np.zeros((*shape, 0))
    return tuple(np.stack(x, axis=-1) if x else empty for x in (force, speed, mu))  # type: ignore[return-value]


def _residual(system: System, time: float, q: Any, force: Any, speed: Any, mu: Any, base: Any) -> tuple[Any, Any]:
    residual = np.einsum("...ij,...j->...i", base, q) - value_at(system.load, time)
    jacobian = np.array(base)
    for i, contact in enumerate(system.contacts):
        normal = force[..., i] + np.sum(contact.n * q, axis=-1)
        closed = (normal > 0.0) if contact.unilateral else np.ones(normal.shape, dtype=bool)
        factor = np.where(closed, mu[..., i] * np.sign(speed[..., i]), 0.0)
        residual = residual - (factor * normal)[..., None] * contact.d
        jacobian = jacobian - factor[..., None, None] * _outer(contact.d, contact.n)
        if contact.unilateral:
            residual = residual - np.where(closed, 0.0, normal)[..., None] * contact.normal
            jacobian = jacobian - np.where(closed, 0.0, 1.0)[..., None, None] * _outer(contact.normal, contact.n)
    return residual, jacobian


def _solve(jacobian: Any, residual: Any) -> tuple[Any, Any]:
    """Solve, with the entries whose matrix is singular to working precision set to a zero step and marked."""
    with np.errstate(all="ignore"):
        singular = ~(_condition(jacobian) < 1.0 / np.finfo(float).eps)
    safe = np.where(singular[..., None, None], np.eye(jacobian.shape[-1]), jacobian)
    step = np.linalg.solve(safe, residual[..., None])[..., 0]
    return np.where(singular[..., None], 0.0, step), singular


def _condition(matrix: Any) -> Any:
    """Condition number by the inverse (1-norm); of 2 x 2 in closed form (Frobenius), many times faster on a map."""
    if matrix.shape[-1] != 2:
        return np.linalg.cond(matrix, 1)
    a = matrix / np.max(np.abs(matrix), axis=(-1, -2), keepdims=True)
    return np.sum(a**2, axis=(-1, -2)) / np.abs(a[..., 0, 0] * a[..., 1, 1] - a[..., 0, 1] * a[..., 1, 0])


def _normal_forces(system: System, time: float, q: Any) -> Any:
    columns = [
        np.maximum(normal, 0.0) if contact.unilateral else normal
        for contact in system.contacts
        for normal in [value_at(contact.N0, time) + np.sum(contact.n * q, axis=-1)]
    ]
    columns = [np.broadcast_to(column, system.shape) for column in columns]
    return np.stack(columns, axis=-1) if columns else np.zeros((*system.shape, 0))


def _equilibrium_outcome(singular: Any, sliding: Any, converged: Any, speed: Any) -> Outcome:
    if np.any(singular):
        message = "K_eff is singular: the friction-coupled stiffness has no unique static deflection"
        return Outcome("singular", message, entries=int(np.sum(singular)))
    if not np.all(sliding):
        contacts = sorted({int(i) for i in np.nonzero(speed == 0.0)[-1]})
        message = f"contact {contacts} has V = 0: it may stick, and any force up to its static limit balances"
        return Outcome("no_sliding", message, contacts=contacts, entries=int(np.sum(~sliding)))
    if not np.all(converged):
        return Outcome("no_convergence", "the set of open contacts did not settle", entries=int(np.sum(~converged)))
    return Outcome(COMPLETED)


def _array(name: str, value: Any, ndim: int) -> np.ndarray:
    try:
        array = np.array(value).astype(float, casting="same_kind")  # refuses complex numbers and texts
    except (TypeError, ValueError) as error:
        raise InvalidSystem(f"{name}: expected an array of real numbers") from error
    if array.ndim < ndim:
        raise InvalidSystem(f"{name} has shape {array.shape}: expected at least {ndim} axes")
    if not np.all(np.isfinite(array)):
        raise InvalidSystem(f"{name} holds a value that is not finite")
    array.flags.writeable = False
    return array


def _check_width(name: str, array: np.ndarray, size: int) -> None:
    if array.shape[-1:] != (size,):
        raise InvalidSystem(f"{name} has shape {array.shape}: expected (..., {size})")


def _outer(a: Any, b: Any) -> Any:
    return np.asarray(a)[..., :, None] * np.asarray(b)[..., None, :]


def _form(a: Any, matrix: Any, b: Any) -> Any:
    """a . matrix b over leading axes; one matrix for all rows goes through one matrix product."""
    product = np.asarray(b) @ matrix.T if np.ndim(matrix) == 2 else np.einsum("...ij,...j->...i", matrix, b)
    return np.sum(np.asarray(a) * product, axis=-1)
