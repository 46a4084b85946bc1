"""`squealbox loop`: poles and margins of a brake with loops."""

from pathlib import Path

from squealbox.cli.answers import show, written
from squealbox.cli.inputs import folder, read
from squealbox.cli.options import AS_WRITTEN, Asked
from squealbox.cli.running import ComputationFailed, UsageError
from squealbox.control import closed_loop
from squealbox.writing import write

ABOUT = {"loop": "poles and margins of a brake with loops: gain, phase, delay, sampling"}


def loop(
    file: Path,
    *,
    asked: Asked = AS_WRITTEN,
    out: Path | None = None,
) -> None:
    """Poles of the closed loop, margins of gain, phase, delay and sampling.

    Parameters
    ----------
    file
        design file with sections [[loops]]
    out
        folder for the poles as table and figure, root locus and Nyquist curve of the first loop
    """
    found = read(file, asked)
    if not found.design.system().loops:
        raise UsageError(f"{file} has no section [[loops]], which says what senses and acts")
    folder(out, "poles", "root_locus", "nyquist")
    closed = closed_loop(found.design)
    show(f"{found.design.title}, {file}", closed)
    if out is not None:
        from squealbox import plots

        title = found.path.name
        paths = write(closed, out, "poles", title=title)
        paths += plots.save(plots.loop_locus(closed, title=title), out / "root_locus")
        paths += plots.save(plots.nyquist_curve(closed, title=title), out / "nyquist")
        print(written(*paths))
    if not closed.outcome.ok:
        raise ComputationFailed(closed.outcome)
