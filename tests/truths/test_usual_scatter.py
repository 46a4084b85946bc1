"""The scatter that is assumed where none is given: what it varies, by how much, and that the table says so."""

import numpy as np
import pytest

from squealbox import (
    Coulomb,
    DrumBrake,
    LinearSlope,
    ModeCoupling,
    OwnBrake,
    OwnContact,
    ParameterError,
    Stribeck,
    silence,
)
from squealbox.remedies import usual_scatter
from squealbox.studies import Scatter


def test_friction_springs_and_dampers_scatter_as_stated():
    lot = usual_scatter(DrumBrake(friction=LinearSlope(0.36, -0.05))).sample(20_000, seed=1)
    assert {"friction.static", "k1", "k2", "k3", "k4", "c1", "c2"} == set(lot)
    spread = {name: np.std(values) / np.mean(values) for name, values in lot.items()}
    expected = {"friction.static": 0.08, "k3": 0.03, "c1": 0.20}
    for name, share in expected.items():
        assert spread[name] == pytest.approx(share, rel=0.03)  # 1/sqrt(2 n) is 0.5 %


def test_static_friction_never_falls_below_kinetic():
    brake = DrumBrake(friction=Stribeck(0.40, 0.38, 0.3))
    lot = usual_scatter(brake).sample(2000, seed=2)
    assert np.min(lot["friction.static"]) >= 0.38
    brake.replace({"friction.static": lot["friction.static"]})  # every one of them is a law


def test_the_table_says_what_was_assumed_and_nothing_where_it_was_given():
    brake = ModeCoupling(c1=0.02, c2=0.02)
    table = silence(brake, candidates=[], push=0.0)
    assert "Assumed scatter" in table.summary()
    assert "brakes in the lot" not in table.summary()
    assert "nan" not in table.summary()  # what was not asked has no column
    assert "after push [um]" not in table.heads()
    own = Scatter(usual_scatter(brake).distributions)
    assert "Assumed" not in silence(brake, own, candidates=[], push=0.0).summary()
    with pytest.raises(ParameterError, match="friction.static = 0.1: expected a distribution"):
        silence(brake, {"friction.static": 0.1})


def test_the_lot_of_a_large_brake_is_smaller_and_said():
    """2048 spectra of 130 states for each of thirty cures took an hour."""
    n = 40
    stiffness = 1e6 * (2.0 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1))
    contacts = [OwnContact(name="pad", n=1e5 * np.eye(n)[0], d=np.eye(n)[1])]
    brake = OwnBrake(M=np.eye(n), C=5.0 * np.eye(n), K=stiffness, contacts=contacts, friction=Coulomb(0.4))
    found = silence(brake, candidates=[], push=0.0)
    assert found.settings["samples"] == 512
    assert "512 brakes in the lot, as each is large: P(squeal) is known to 4 % or better" in found.summary()
    asked = silence(brake, candidates=[], push=0.0, samples=64)  # the twin: what is asked is taken
    assert (asked.settings["samples"], "in the lot" in asked.summary()) == (64, False)
