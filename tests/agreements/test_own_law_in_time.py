"""A law of plain functions moves a block as the law it writes out does: compiled from its text."""

import numpy as np
import pytest

from squealbox import Coulomb, MassOnBelt, Stribeck, own_law, simulate
from squealbox.friction import LAWS
from squealbox.parameters import ParameterError, from_plain
from squealbox.system import InvalidSystem
from squealbox.transient import _engine
from squealbox.transient.own_laws import law_kinds, own_texts

TEXT = "def mu(v, p):\n    return p[1] + (p[0] - p[1]) * np.exp(-v / p[2])\n"
NUMBERS = (0.3, 0.2)


def test_motion_is_that_of_the_written_out_law():
    own = MassOnBelt(friction=own_law(TEXT, numbers=NUMBERS, static=0.5))
    known = MassOnBelt(friction=Stribeck(0.5, *NUMBERS))
    ours, theirs = (simulate(block, 20.0, times=201, rtol=1e-9) for block in (own, known))
    assert ours.outcome == theirs.outcome == "completed"
    # the derived slope only steers the search for events; the motion agrees to the integrator's tolerance
    assert np.max(np.abs(ours.q - theirs.q)) < 1e-6
    other = simulate(MassOnBelt(friction=Coulomb(0.5, 0.3)), 20.0, times=201)
    assert np.max(np.abs(other.q - theirs.q)) > 1e-2


def test_the_generated_file_holds_the_source_and_changes_with_it():
    first, second = own_law(TEXT, numbers=NUMBERS, static=0.5), own_law("def mu(v, p): return 0.3 + 0.0 * v")
    contacts = [MassOnBelt(friction=law).system().contacts[0] for law in (first, Coulomb(0.3), second, first)]
    own = own_texts(contacts)
    own_kind = len(LAWS)  # own laws come after those of the house
    assert law_kinds(contacts).tolist() == [own_kind, 0, own_kind + 1, own_kind]
    plain: dict = {}
    exec(_engine.laws_and_schedules(own, plain=True), plain)
    p = np.array(first.coefficients())
    for v in (0.0, 0.1, 1.3):
        assert plain["law_mu"](own_kind, v, p) == pytest.approx(float(first.mu(v)), rel=1e-15)
        assert plain["law_slope"](own_kind, v, p) == pytest.approx(float(first.slope_at(v)), rel=1e-12)
        assert plain["law_mu"](own_kind + 1, v, p) == 0.3
    written = _engine.laws_and_schedules
    assert written(own) != written(own[:1]) != written()


def test_a_law_that_was_only_read_is_not_compiled():
    data = {"kind": "files.own_law.OwnLaw", "source": "def mu(v, p):\n    return 0.37 + 0.0 * v", "static": 0.37}
    with pytest.raises(ParameterError, match="allow"):
        simulate(MassOnBelt(friction=from_plain(data)), 1.0)


def test_a_law_without_source_is_refused():
    class Strange(Coulomb):
        pass

    with pytest.raises(InvalidSystem, match="can be compiled"):
        simulate(MassOnBelt(friction=Strange(0.3)), 1.0)
