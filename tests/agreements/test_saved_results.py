"""Files of results are what xarray reads as their datasets; tests/house/test_results_in_notebooks tries every kind."""

import numpy as np
import xarray

from squealbox.labelled import Labelled, Labels


def test_words_signs_and_empty_arrays_keep_their_kind(tmp_path):
    values = {
        "words": np.array(["glatt", "größe", ""]),
        "yes": np.array([True, False, True]),
        "z": np.array([1 + 2j, 0, -1j]),
        "count": np.arange(3),
        "same": np.array(["ab", "ab", "ab"]),
        "mixed": np.array(["a", "größer", "c"], dtype=object),
    }
    variables = {name: Labels(("place",), array, {"units": "N"}) for name, array in values.items()}
    variables |= {"one": Labels((), np.array(3.0), {}), "none": Labels(("nothing",), np.zeros(0), {})}
    aside = {"hertz": Labels(("place",), np.array([1.0, 2.0, np.nan]), {"units": "Hz"})}
    whole = Labelled(variables, aside, {"title": "µ"})
    assert whole.sizes == {"place": 3, "nothing": 0}
    whole.write(tmp_path / "words.part")
    with xarray.open_dataset(tmp_path / "words.part", engine="h5netcdf") as read:
        xarray.testing.assert_identical(read.load(), whole.dataset())
        assert read["yes"].dtype == bool
        assert "hertz" in read.coords
