"""`squealbox reduce`: a small brake from a finite-element one, in a file that opens again as a brake."""

import dataclasses
from pathlib import Path

from squealbox.cli.answers import written
from squealbox.cli.inputs import NOTHING_SAID, Said, free, read
from squealbox.cli.options import AS_WRITTEN, Asked
from squealbox.cli.running import UsageError
from squealbox.fe import ReducedBrake, save_reduced
from squealbox.files import Reduce, Reduced, dense, error_table, promise
from squealbox.waiting import Progress

ABOUT = {"reduce_": "a small brake from a finite-element one, with its error, in a file"}


def reduce_(file: Path, *, out: Path, how: Said[Reduce] = NOTHING_SAID, asked: Asked = AS_WRITTEN) -> None:
    """Make a small brake of a finite-element one: its modes in a band are those of the full one, with a known error.

    It is reduced for everything that the file varies: varying of [reduce], [onset], [branch], [map], [scatter]. A file
    with brake = "reduced" and file = "small.npz" then goes through every command in no time.

    Parameters
    ----------
    file
        design file of a finite-element brake
    out
        the .npz file that is written; M, C and K in it are for any program
    """
    found = read(file, asked)
    if out.suffix.lower() != ".npz":
        raise UsageError(f"--out {out}: expected a name that ends in .npz")
    if not found.design.system().is_sparse:
        raise UsageError(f"{file} is no finite-element brake: its matrices are dense and need no reduction")
    given = found.reduce or Reduced(Reduce(), {})
    found = dataclasses.replace(found, reduce=dataclasses.replace(given, how=how.over(given.how)))
    free(out)
    with Progress("reducing the finite-element brake"):
        small = dense(found).design
    assert isinstance(small, ReducedBrake)
    out.parent.mkdir(parents=True, exist_ok=True)
    print(f"{found.design.title}, {file}\n{promise(small)}\n{error_table(small)}")
    print(written(save_reduced(small, out)))
