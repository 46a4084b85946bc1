"""A brake given by its matrices is one brake, not a map of them: it can be examined for a report."""

import numpy as np
import pytest

from squealbox import Coulomb, DrumBrake, OwnBrake, OwnContact
from squealbox.parameters import ParameterError
from squealbox.report import examine
from squealbox.transient import MotionSettings


def test_an_own_brake_is_examined():
    contact = OwnContact(n=[0.0, 1.0], d=[1.0, 0.0])
    brake = OwnBrake(
        M=np.eye(2), K=[[2.0, 1.0], [1.0, 2.0]], C=0.1 * np.eye(2), friction=Coulomb(0.5), normal_force=10.0,
        contacts=(contact,),
    )  # fmt: skip
    found = examine(brake, simulate=MotionSettings(duration=20.0, times=101))
    assert found.modes.outcome.ok
    assert found.motion.outcome.ok


def test_a_map_of_brakes_is_refused():
    with pytest.raises(ParameterError, match="not a map of brakes"):
        examine(DrumBrake().replace({"friction.static": np.linspace(0.1, 0.5, 3)}))
