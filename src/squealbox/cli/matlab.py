"""A sweep as a MAT file: names that MATLAB takes, units beside them, words as cells."""

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from squealbox.labelled import whole

if TYPE_CHECKING:
    from squealbox.studies import Sweep

LONGEST = 63  # characters of a MATLAB name


def write_mat(path: Path, found: "Sweep") -> Path:
    """Write the parameters, outcomes and answers to `path`, whole or not at all."""
    from scipy.io import savemat

    dataset = found.dataset
    holds: dict[str, Any] = {}
    units: dict[str, str] = {}
    names: dict[str, str] = {}
    for variable in [*dataset.coords, *dataset.data_vars]:
        name = _name(str(variable), holds)
        values = np.asarray(dataset[variable].values)
        holds[name] = values.astype(object) if values.dtype.kind in "OU" else values
        units[name], names[name] = str(dataset[variable].attrs.get("units", "")), str(variable)
    dimensions = {_name(str(v), {}): " x ".join(map(str, dataset[v].dims)) for v in dataset.data_vars}
    holds |= {"units": units, "names": names, "dimensions": dimensions, "study": str(dataset.attrs.get("settings", ""))}
    with whole(path) as part, part.open("wb") as stream:
        savemat(stream, holds, long_field_names=True, oned_as="column", do_compression=True)
    return path


def _name(text: str, taken: dict[str, Any]) -> str:
    name = re.sub(r"\W", "_", text)[:LONGEST]
    name = name if name[:1].isalpha() else f"x_{name}"[:LONGEST]
    while name in taken or name in ("units", "names", "dimensions", "study"):
        name = f"{name[: LONGEST - 1]}_"
    return name
