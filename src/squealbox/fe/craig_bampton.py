"""Craig and Bampton's basis: every freedom at a contact is kept, the rest follows statically and by its own modes.

    q = [q_b, q_i],   q_i = -K_ii^-1 K_ib q_b + Phi eta,   (K_ii - w^2 M_ii) phi = 0

Craig and Bampton 1968, AIAA Journal 6, 1313-1319.
"""

from typing import Any

import numpy as np

from squealbox.factorisation import factor
from squealbox.fe.basis import joined
from squealbox.fe.pencil import Pencil
from squealbox.fe.undamped_modes import real_modes
from squealbox.system import InvalidSystem

MOST = 1500  # freedoms at contacts that a dense system can hold


def craig_bampton_basis(pencil: Pencil, kept: np.ndarray, top: float) -> Any:
    """Columns V (n, m), V' M V = I: static shapes of the `kept` freedoms, and modes below `top` [Hz] with those held.

    Raises `InvalidSystem` where there are too many freedoms to keep.
    """
    if len(kept) > MOST:
        raise InvalidSystem(
            f"{len(kept)} freedoms touch a contact: Craig-Bampton keeps them all, at most {MOST}; "
            "method='enriched' keeps the contacts without their freedoms"
        )
    size = pencil.size
    inner = np.setdiff1d(np.arange(size), kept)
    stiffness, mass = pencil.elastic.tocsc(), pencil.M.tocsc()
    inside = stiffness[inner][:, inner]
    static = np.zeros((size, len(kept)))
    static[kept, np.arange(len(kept))] = 1.0
    if len(inner):
        static[inner] = -factor(inside, symmetric=True).solve_many(stiffness[inner][:, kept].toarray())
    held = real_modes(inside.tocsr(), mass[inner][:, inner].tocsr(), top)
    modes = np.zeros((size, held.shapes.shape[1]))
    modes[inner] = held.shapes
    return joined(pencil, np.zeros((size, 0)), np.concatenate([static, modes], axis=1))
