"""A reduced brake in one `.npz` file: M, C, K for any program, and everything that opens it again as a brake here."""

import json
import os
import zipfile
from pathlib import Path

import numpy as np

from squealbox.fe.readers.matrix import MatrixFileError
from squealbox.fe.reduced_brake import ReducedBrake
from squealbox.labelled import whole
from squealbox.parameters import ParameterError, from_plain, to_plain

MEMBER = "squealbox"
LARGEST = 2_000_000_000  # bytes that a file may unfold to


def save_reduced(brake: ReducedBrake, path: str | os.PathLike[str]) -> Path:
    """Write the brake, whole or not at all, and return the path; the full brake is not in the file.

    The members M, C and K are the matrices (m, m) at the values it was reduced at, without contact forces.
    """
    path = Path(path)
    if path.suffix.lower() != ".npz":
        raise ParameterError("save_reduced", "path", str(path), "a name that ends in .npz")
    text = json.dumps(to_plain(brake)).encode()
    matrices = {name: np.asarray(brake.array(name)) for name in ("M", "C", "K")}
    with whole(path) as part, part.open("wb") as stream:
        np.savez_compressed(stream, **{MEMBER: np.frombuffer(text, dtype=np.uint8)}, **matrices)  # type: ignore[arg-type]
    return path


def load_reduced(path: str | os.PathLike[str]) -> ReducedBrake:
    """The brake that `save_reduced` wrote; raises `MatrixFileError` for a file that holds none."""
    path = Path(path)
    try:
        with zipfile.ZipFile(path) as archive:
            if sum(info.file_size for info in archive.infolist()) > LARGEST:
                raise MatrixFileError(path, f"unfolds to more than {LARGEST / 1e9:g} GB")
        with np.load(path, allow_pickle=False) as stored:
            if MEMBER not in stored.files:
                raise MatrixFileError(path, "holds no reduced brake: expected a file of squealbox reduce")
            brake = from_plain(json.loads(stored[MEMBER].tobytes()))
    except OSError as error:
        raise MatrixFileError(path, f"cannot be read: {error.strerror or error}") from error
    except (zipfile.BadZipFile, ValueError, TypeError, KeyError, AttributeError, EOFError) as error:
        if isinstance(error, MatrixFileError):
            raise
        raise MatrixFileError(path, f"is no reduced brake, or a damaged one: {error}") from error
    if not isinstance(brake, ReducedBrake):
        raise MatrixFileError(path, "holds no reduced brake: expected a file of squealbox reduce")
    return brake
