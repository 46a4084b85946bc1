"""What a study and a report say of a run belongs to the motion, not to the instants somebody keeps."""

import numpy as np
import pytest

from squealbox import DrumBrake, LinearSlope
from squealbox.cli.study_analyses import judged_motion
from squealbox.transient import MotionSettings, verdict


def test_few_instants_do_not_change_the_verdict():
    brake = DrumBrake(friction=LinearSlope(static=0.45, slope=-0.05))
    found = judged_motion(brake, MotionSettings(duration=0.3, times=301))
    assert found["frequency"][0] == pytest.approx(2034.6, abs=0.1)
    assert found["amplitude"][0] == pytest.approx(7.68e-6, rel=2e-3)
    few = verdict(MotionSettings(duration=0.3, times=301).run(brake.system()))
    assert few.frequency == pytest.approx(2034.6, abs=0.1)  # followed again at its own steps
    kept = MotionSettings(duration=0.3, times=301).run(brake.system())
    aliased = verdict(kept.q[:, 0], kept.t)
    assert abs(aliased.frequency - 2034.6) > 100.0  # the twin: bare instants at 1 kHz cannot carry 2 kHz
    assert MotionSettings(duration=0.01, times=5001).run_closely(brake.system()).t.size == 5001
    assert np.isclose(MotionSettings(duration=0.3, times=301).run_closely(brake.system()).t[-1], 0.3)
