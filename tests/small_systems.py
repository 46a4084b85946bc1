"""Systems of one or two degrees of freedom that the tests of the transient engine share."""

import numpy as np

from squealbox import Contact, Coulomb, DrumBrake, LinearSlope, System

METHODS = ("bogacki-shampine", "dormand-prince", "tsitouras", "dormand-prince-8")
READINGS = ("eq1_printed", "eq3", "eq3_signed", "componentwise", "consistent")


def block_on_belt(law, speed, *, mass=1.0, damping=0.0, stiffness=1.0, normal=1.0, load=0.0):
    """m x'' + c x' + k x = f + mu(|v|) sgn(v) N with v = V - x'."""
    contact = Contact(n=[0.0], d=[1.0], t=[1.0], N0=normal, V=speed, law=law)
    return System([[mass]], [[damping]], [[stiffness]], load, (contact,))


def two_blocks_on_belt(first=None, second=None, *, speed=0.1, coupling=1.2, damping=0.02):
    """Two blocks on one belt, each held by a spring and joined by another."""
    laws = (first or Coulomb(0.4, 0.25), second or Coulomb(0.5, 0.3))
    normal = (1.0, 1.3)
    contacts = tuple(
        Contact(np.zeros(2), row, row, N0=force, V=speed, law=law)
        for row, force, law in zip(np.eye(2), normal, laws, strict=True)
    )
    stiffness = np.array([[1.0 + coupling, -coupling], [-coupling, 1.4 + coupling]])
    return System(np.eye(2), damping * np.eye(2), stiffness, 0.0, contacts)


def drum(friction=0.44, reading="consistent", *, slope=-0.05, preload=None):
    """The drum of 2011; `preload` [N] is put on every contact."""
    system = DrumBrake(friction=LinearSlope(friction, slope), reading=reading).system()
    if preload is None:
        return system
    return system.replace({"contacts": tuple(contact.replace({"N0": preload}) for contact in system.contacts)})


def two_masses():
    """Two masses without contacts: damped, with a skew part in K, under a constant load."""
    return System(
        M=[[1.0, 0.1], [0.1, 2.0]],
        C=[[0.05, 0.01], [-0.02, 0.08]],
        K=[[3.0, -1.5], [-0.7, 4.0]],
        load=[0.3, -0.2],
    )


def extremes(motion):
    """(instants, displacements) of the maxima of the first displacement, by the Hermite cubic of each step."""
    t, x, v = motion.t, motion.q[:, 0], motion.qd[:, 0]
    i = np.flatnonzero((v[:-1] > 0.0) & (v[1:] <= 0.0))
    h, rise = t[i + 1] - t[i], x[i + 1] - x[i]
    a = h * (v[i] + v[i + 1]) - 2.0 * rise  # x = x_i + s (h v_i + s (b + s a))
    b = 3.0 * rise - h * (2.0 * v[i] + v[i + 1])
    s = -h * v[i] / (b - np.sqrt(b * b - 3.0 * a * h * v[i]))
    return t[i] + s * h, x[i] + s * (h * v[i] + s * (b + s * a))
