"""A text from elsewhere (pasted, or carried by a link) reads no file of this machine, and no NaN breaks a frame."""

import numpy as np
import pytest

from squealbox.files import DesignFileError, read_text
from squealbox.workbench.frames import frame, unframed

OWN = """brake = "own"
M = "K.npy"
C = [[0.0, 0.0], [0.0, 0.0]]
K = "K.npy"
[[contacts]]
n = [0.0, 0.0]
d = [1.0, 0.0]
t = [1.0, 0.0]
normal_force = "1 N"
sliding_speed = "1 m/s"
friction = { law = "coulomb", static = 0.3 }
"""


def test_files_beside_a_pasted_text_are_not_opened(tmp_path, monkeypatch):
    np.save(tmp_path / "K.npy", 4711.0 * np.eye(2))
    monkeypatch.chdir(tmp_path)
    with pytest.raises(DesignFileError, match="a pasted text or a link cannot name") as caught:
        read_text(OWN, "the file", beside=False)
    assert "4711" not in str(caught.value)
    assert read_text(OWN, "design.toml").design.system().K[0, 0] == 4711.0  # the twin: beside its own file it is


def test_what_is_not_finite_is_null_wherever_it_stands():
    header, arrays = unframed(
        frame({"id": 1, "data": {"a": [np.nan, {"b": np.float64(np.inf)}], "c": 2.0}}, {"x": [np.nan]})
    )
    assert header["data"] == {"a": [None, {"b": None}], "c": 2.0}
    assert np.isnan(arrays["x"]).all()
