"""What finite-element codes write, as sparse matrices with labels. Depends on: nothing but NumPy and SciPy."""

from squealbox.fe.readers.matrix import FileMatrix, MatrixFile, MatrixFileError
from squealbox.fe.readers.opening import open_matrices

__all__ = ["FileMatrix", "MatrixFile", "MatrixFileError", "open_matrices"]
