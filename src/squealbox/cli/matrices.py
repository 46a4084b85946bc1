"""`squealbox matrices`: what the files of a finite-element code hold."""

from pathlib import Path

from squealbox.cli.running import UsageError
from squealbox.fe import MatrixFileError, described
from squealbox.parameters import ParameterError

ABOUT = {"matrices": "what files of Abaqus, Nastran, Ansys ... hold: matrices, labels, frequencies"}


def matrices(*files: Path, units: str | None = None, count: int = 6) -> None:
    """What matrix files hold: format, size, entries, symmetry, labels, digits, massless and constrained freedoms.

    Of files that belong together, a mass and a stiffness file say, also the first natural frequencies, which should be
    those the code itself printed.

    Parameters
    ----------
    files
        files of Abaqus, Nastran, Ansys, OptiStruct, CalculiX, MatrixMarket, NumPy or MATLAB, told by their content
    units
        "mm t s", "mm kg ms", "SI" ...: no file says its units; with them the mass is in kg and checked
    count
        how many frequencies
    """
    if not files:
        raise UsageError("no files: expected matrix files, such as job_STIF1.mtx job_MASS1.mtx")
    if not 1 <= count <= 1000:
        raise UsageError(f"--count {count}: expected 1 to 1000")
    try:
        print(described(files, count, units))
    except (MatrixFileError, ParameterError) as error:
        raise UsageError(str(error)) from error
