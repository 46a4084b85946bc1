"""Contacts: one frictional contact as a row of the equation in `system.py`, and many of them as one table.

A contact senses along n (normal force, N/m) and t (sliding), and acts along d. Where sliding is in a plane, friction
points along the relative velocity: a small velocity a . q' across the sliding direction turns it, and the force that
acts along a is -mu N (a . q') / |V|. The row a is `across`; other codes call its effect friction-induced damping.
"""

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
import scipy

from squealbox.law import FrictionLaw
from squealbox.matrices import InvalidSystem, array, is_sparse
from squealbox.parameters import DataSheet
from squealbox.schedules import Schedule, value_at

if TYPE_CHECKING:
    from scipy.sparse import sparray

ROWS = ("n", "d", "t", "normal", "across")  # of these, normal and across may be missing


def numbered(names: Sequence[str]) -> tuple[str, ...]:
    """The names of contacts, "contact 1" and so on where there is none."""
    return tuple(name or f"contact {i}" for i, name in enumerate(names, start=1))


class Contact(DataSheet):
    """One frictional contact: it senses along n and t, and acts along d.

    Parameters
    ----------
    n : shape (..., n), [N/m] normal force per displacement; like d, t, normal and across, a sparse row is taken too
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
    across : shape (..., n), [-] row a of the velocity across the sliding direction, along which friction acts too: it
        turns with the relative velocity, and C_eff gains mu N / |V| a a'. None where sliding has one direction only
    """

    told: ClassVar = {
        "n": ("N/m", "normal force per displacement"),
        "d": ("", "where friction acts on the degrees of freedom"),
        "t": ("", "sliding velocity per velocity"),
        "N0": ("N", "normal force at q = 0"),
        "V": ("m/s", "sliding speed at rest"),
        "unilateral": ("", "opens instead of pulling"),
        "normal": ("", "direction of the normal reaction"),
        "gap": ("m", "gap of a rigid contact at q = 0"),
        "restitution": ("", "rebound speed over landing speed of a rigid contact"),
        "across": ("", "velocity across the sliding direction"),
    }

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
    across: Any = None

    def __post_init__(self) -> None:
        for field in ROWS:
            if getattr(self, field) is not None:
                object.__setattr__(self, field, _row(f"{self._title}.{field}", getattr(self, field)))
        for field in ("N0", "V"):
            if not isinstance(getattr(self, field), Schedule):
                object.__setattr__(self, field, array(f"{self._title}.{field}", getattr(self, field), 0))
        if not isinstance(self.law, FrictionLaw):
            given = self.law.__name__ if isinstance(self.law, type) else repr(self.law)  # type: ignore[unreachable]
            raise InvalidSystem(f"{self._title}.law = {given}: expected a friction law, such as Coulomb(0.4)")
        if self.unilateral and self.normal is None:
            raise InvalidSystem(f"{self._title}.normal is missing: a unilateral contact needs its direction")
        self._check_rigid()

    @property
    def _title(self) -> str:
        return f"contact {self.name}" if self.name else "contact"

    @classmethod
    def kind(cls) -> str:
        """The name a file knows it by, from before contacts had a module of their own."""
        return f"system.{cls.__name__}"

    def _check_rigid(self) -> None:
        name = self._title
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
        if self.across is not None:
            raise InvalidSystem(f"{name}.across is given: a rigid contact slides in one direction only")
        if np.any(self.n) or isinstance(self.N0, Schedule) or np.any(self.N0):
            raise InvalidSystem(
                f"{name}: a rigid contact's normal force follows from the motion; expected n = 0, N0 = 0"
            )


class Contacts(DataSheet):
    """Many contacts as one table, whose rows may be sparse: those of a finite-element brake.

    Parameters
    ----------
    n, d, t : shape (contacts, n), the rows of :class:`Contact`, dense or SciPy sparse
    N0 : [N] normal forces at q = 0; number, shape (contacts,), or a sequence that may hold schedules
    V : [m/s] sliding speeds at rest, likewise
    law : one friction law for all, whose coefficients may have shape (contacts,), or a sequence of laws
    names : what tables and plots call them
    unilateral : True where they open instead of pulling; one for all, or shape (contacts,)
    normal : shape (contacts, n), direction of the reaction; needed where unilateral
    across : shape (contacts, n), rows across the sliding direction, None where there are none

    A table reads as a sequence of `Contact`. Raises `InvalidSystem` where shapes disagree.

    >>> from squealbox.friction import Coulomb
    >>> pads = Contacts(n=np.eye(2), d=np.eye(2), t=np.eye(2), N0=1.0, V=[1.0, 2.0], law=Coulomb(0.4))
    >>> len(pads), float(pads[1].V)
    (2, 2.0)
    """

    n: Any
    d: Any
    t: Any
    N0: Any
    V: Any
    law: Any
    names: tuple[str, ...] = ()
    unilateral: Any = False
    normal: Any = None
    across: Any = None

    def __post_init__(self) -> None:
        set_ = object.__setattr__
        for field in ROWS:
            if getattr(self, field) is not None:
                set_(self, field, _rows(f"contacts.{field}", getattr(self, field)))
        shape = self.n.shape
        for field in ROWS:
            rows = getattr(self, field)
            if rows is not None and rows.shape != shape:
                raise InvalidSystem(f"contacts.{field} has shape {rows.shape}: expected {shape}, that of contacts.n")
        for field in ("N0", "V"):
            set_(self, field, _each(f"contacts.{field}", getattr(self, field), shape[0]))
        set_(self, "law", self._checked_laws())
        unilateral = np.broadcast_to(np.asarray(self.unilateral, dtype=bool), shape[:1])
        set_(self, "unilateral", unilateral)
        if np.any(unilateral) and self.normal is None:
            raise InvalidSystem("contacts.normal is missing: unilateral contacts need their directions")
        names = tuple(self.names) or numbered([""] * shape[0])
        if len(names) != shape[0]:
            raise InvalidSystem(f"contacts.names holds {len(names)} names: expected {shape[0]}")
        set_(self, "names", names)

    def _checked_laws(self) -> Any:
        laws = self.law if isinstance(self.law, FrictionLaw) else tuple(self.law)
        count = self.n.shape[0]
        if isinstance(laws, tuple) and (len(laws) != count or not all(isinstance(law, FrictionLaw) for law in laws)):
            raise InvalidSystem(f"contacts.law: expected one friction law, or {count}")
        for law in laws if isinstance(laws, tuple) else (laws,):
            for value in law.coefficients():
                given = np.shape(value)
                if given not in ((), (count,)) or (isinstance(laws, tuple) and given):
                    raise InvalidSystem(f"contacts.law has coefficients of shape {given}: expected () or ({count},)")
        return laws

    @classmethod
    def of(cls, contacts: Sequence[Contact], size: int) -> "Contacts":
        """The table of single contacts in a system of `size` degrees of freedom."""
        for i, contact in enumerate(contacts):
            if contact.rigid:
                raise InvalidSystem(f"contacts[{i}] is rigid: a table holds contacts with a stiffness")
            for field in ROWS:
                row = getattr(contact, field)
                if row is not None and np.prod(row.shape[:-1]) != 1:
                    raise InvalidSystem(f"contacts[{i}].{field} has leading axes: a table is of one system")
        laws = [contact.law for contact in contacts]
        rows = {field: _stacked([getattr(contact, field) for contact in contacts], size) for field in ROWS}
        if not any(contact.unilateral for contact in contacts):
            rows["normal"] = None
        if all(contact.across is None for contact in contacts):
            rows["across"] = None
        return cls(
            n=rows["n"],
            d=rows["d"],
            t=rows["t"],
            N0=[contact.N0 for contact in contacts],
            V=[contact.V for contact in contacts],
            law=laws[0] if laws and all(law is laws[0] for law in laws) else laws,
            names=numbered([contact.name for contact in contacts]),
            unilateral=np.array([contact.unilateral for contact in contacts], dtype=bool),
            normal=rows["normal"],
            across=rows["across"],
        )

    def __len__(self) -> int:
        return int(self.n.shape[0])

    def __iter__(self) -> Iterator[Contact]:
        return (self[i] for i in range(len(self)))

    def __getitem__(self, index: int) -> Contact:
        if not -len(self) <= index < len(self):
            raise IndexError(f"contact {index}: the table holds {len(self)}")
        return self._contact(range(len(self))[index], {f: getattr(self, f) for f in ROWS})

    def dense(self) -> tuple[Contact, ...]:
        """The same contacts with dense rows, one by one."""
        rows = {field: getattr(self, field) for field in ROWS}
        rows = {field: None if table is None else table.toarray() for field, table in rows.items()}
        return tuple(self._contact(i, rows) for i in range(len(self)))

    def _contact(self, i: int, rows: dict[str, Any]) -> Contact:
        row: dict[str, Any] = {f: None if r is None else r[[i]] if is_sparse(r) else r[i] for f, r in rows.items()}
        if not self.unilateral[i]:
            row["normal"] = None
        about: dict[str, Any] = {"name": self.names[i], "unilateral": bool(self.unilateral[i]), "law": self.law_of(i)}
        return Contact(N0=self.N0[i], V=self.V[i], **row, **about)

    def law_of(self, index: int) -> FrictionLaw:
        """The friction law of one contact."""
        if isinstance(self.law, tuple):
            law: FrictionLaw = self.law[index]
            return law
        own = {name: value[index] for name, _, value in self.law.leaves() if np.ndim(value) == 1}
        return self.law.replace(own) if own else self.law

    def at(self, name: str, time: float = 0.0) -> Any:
        """N0 [N] or V [m/s] of all contacts at `time` [s], shape (contacts,)."""
        values = getattr(self, name)
        return np.array([value_at(value, time) for value in values], float) if isinstance(values, tuple) else values

    def friction(self, speed: np.ndarray) -> tuple[Any, Any]:
        """mu [-] and its slope [s/m] at the sliding speeds (contacts,)."""
        if isinstance(self.law, FrictionLaw):
            pair = self.law.mu(speed), self.law.slope_at(speed)
            return tuple(np.broadcast_to(part, (len(self),)) for part in pair)  # type: ignore[return-value]
        mu, slope = np.empty(len(self)), np.empty(len(self))
        groups: dict[FrictionLaw, list[int]] = {}
        for i, law in enumerate(self.law):
            groups.setdefault(law, []).append(i)
        for law, members in groups.items():
            mu[members], slope[members] = law.mu(speed[members]), law.slope_at(speed[members])
        return mu, slope


def _stacked(rows: Sequence[Any], size: int) -> Any:
    """Rows, dense, sparse or missing, as one sparse table."""
    empty = scipy.sparse.csr_array((1, size))
    parts = [empty if row is None else scipy.sparse.csr_array(row.reshape((1, -1))) for row in rows]
    return scipy.sparse.vstack(parts, format="csr") if parts else scipy.sparse.csr_array((0, size))


def _each(name: str, values: Any, count: int) -> Any:
    """An array (count,), or a tuple where a schedule is among the values."""
    if isinstance(values, Schedule):
        return (values,) * count
    if isinstance(values, (list, tuple)) and any(isinstance(value, Schedule) for value in values):
        if len(values) != count:
            raise InvalidSystem(f"{name} holds {len(values)} values: expected {count}")
        return tuple(values)
    found = array(name, [float(np.squeeze(v)) for v in values] if isinstance(values, (list, tuple)) else values, 0)
    if found.shape not in ((), (count,)):
        raise InvalidSystem(f"{name} has shape {found.shape}: expected ({count},)")
    return np.broadcast_to(found, (count,))


def _rows(name: str, rows: "np.ndarray | sparray") -> Any:
    """A table of rows in compressed sparse rows, whose values are real and finite."""
    if is_sparse(rows):
        return _finite(name, rows if isinstance(rows, scipy.sparse.csr_array) else scipy.sparse.csr_array(rows))
    table = array(name, rows, 2)
    if table.ndim != 2:
        raise InvalidSystem(f"{name} has shape {table.shape}: expected (contacts, n)")
    return scipy.sparse.csr_array(table)


def _row(name: str, row: Any) -> Any:
    if not is_sparse(row):
        return array(name, row, 1)
    kept = scipy.sparse.csr_array(row.reshape((1, -1)) if row.ndim == 1 else row)
    if kept.shape[0] != 1:
        raise InvalidSystem(f"{name} has shape {kept.shape}: expected one sparse row, (1, n)")
    return _finite(name, kept)


def dense_rows(contact: Contact) -> Contact:
    """The contact with its sparse rows, if it has any, made dense."""
    rows = {field: getattr(contact, field) for field in ROWS}
    rows = {field: row.toarray()[0] for field, row in rows.items() if is_sparse(row)}
    return contact.replace(rows) if rows else contact


def sparse_matrix(name: str, matrix: "sparray", ndim: int = 2) -> Any:
    """A matrix in compressed sparse rows, finite and real, or `InvalidSystem`."""
    if is_sparse(matrix):
        return _finite(name, matrix if isinstance(matrix, scipy.sparse.csr_array) else scipy.sparse.csr_array(matrix))
    found = array(name, matrix, ndim)
    if found.ndim != 2:
        raise InvalidSystem(f"{name} has shape {found.shape}: beside sparse matrices expected one matrix, (n, n)")
    return scipy.sparse.csr_array(found)


def _finite(name: str, table: "sparray") -> Any:
    """A sparse array of finite real numbers without duplicate entries, or `InvalidSystem`.

    A copy that cannot be written to; such a one is taken as it is, so that systems of one brake share their matrices.
    """
    if table.data.dtype == float and not table.data.flags.writeable and table.has_canonical_format:
        return table
    if np.iscomplexobj(table.data):
        raise InvalidSystem(f"{name}: expected an array of real numbers")
    table = table.astype(float)
    if not np.all(np.isfinite(table.data)):
        raise InvalidSystem(f"{name} holds a value that is not finite")
    return unchanging(table)


def unchanging(table: "sparray") -> Any:
    """A sparse array without duplicate entries that can no longer be written to."""
    table.sum_duplicates()
    for part in (table.data, table.indices, table.indptr):
        part.flags.writeable = False
    return table
