"""Tables with semicolons, tabs, decimal commas and other code pages hold the same numbers as plain ones."""

import numpy as np
import pytest

from squealbox import read_recording
from squealbox.cells import cells
from squealbox.files import read_points
from squealbox.files.matrix_text import ArrayFileError, read_csv

V, MU = [0.0, 0.25, 1.5, 3.0], [0.42, 0.4, 0.375, 0.36]
WRITTEN = {
    "plain": (",", ".", "utf-8"),
    "German": (";", ",", "utf-8-sig"),
    "German, Excel of old": (";", ",", "cp1252"),
    "tabs": ("\t", ".", "utf-8"),
    "tabs and commas, Unicode text of Excel": ("\t", ",", "utf-16"),
    "semicolons and points": (";", ".", "utf-8"),
}


def written(how, rows, head=None):
    """A table as bytes, the way one country writes it."""
    mark, point, code = WRITTEN[how]
    lines = [mark.join(head)] if head else []
    lines += [mark.join(repr(x).replace(".", point) for x in row) for row in rows]
    return ("\n".join(lines) + "\n").encode(code)


@pytest.mark.parametrize("how", WRITTEN)
def test_every_reader_of_tables_reads_it(how, tmp_path):
    rows = list(zip(V, MU, strict=True))
    (tmp_path / "mu.csv").write_bytes(written(how, rows, ("Größe v [m/s]", "mu")))
    np.testing.assert_array_equal(read_points(tmp_path / "mu.csv"), (V, MU))
    np.testing.assert_array_equal(read_csv(written(how, rows), 100), np.array(rows))
    t = np.arange(64) / 64.0
    samples = [(float(a), float(b)) for a, b in zip(t, np.sin(20.0 * t).round(6), strict=True)]
    (tmp_path / "stop.csv").write_bytes(written(how, samples, ("t [s]", "Schalldruck größer [Pa]")))
    recording = read_recording(tmp_path / "stop.csv")
    assert recording.rate == pytest.approx(64.0)
    np.testing.assert_array_equal(recording.samples[:, 0], [b for _, b in samples])


def test_what_is_not_sure_is_not_guessed():
    """A comma beside points may part thousands: the cell stays as it is, and is then no number."""
    assert cells(b"1.5;2,500\n") == [(1, ["1.5", "2,500"])]
    with pytest.raises(ArrayFileError, match="decimal comma"):
        read_csv(b"1.5;2,500\n2.5;1.0\n", 100)
    with pytest.raises(ArrayFileError):
        read_csv(bytes(range(256)), 100)


def test_lines_keep_their_numbers():
    assert cells(b"# measured\n\n1,2\n# pause\n3,4\n") == [(3, ["1", "2"]), (5, ["3", "4"])]
