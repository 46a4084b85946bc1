"""`squealbox loop`: poles and margins of a brake with loops."""

from pathlib import Path

from squealbox.cli.answers import show
from squealbox.cli.inputs import folder, read
from squealbox.cli.options import AS_WRITTEN, Asked
from squealbox.cli.running import ComputationFailed, UsageError
from squealbox.cli.tables import kept, written
from squealbox.control import closed_loop

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

        columns = {"growth rate [1/s]": closed.poles.real, "frequency [Hz]": closed.frequency}
        title = found.path.name
        paths = kept(closed, out / "poles", columns, title=title)
        paths += plots.save(plots.loop_locus(closed, title=title), out / "root_locus")
        paths += plots.save(plots.nyquist_curve(closed, title=title), out / "nyquist")
        print(written(*paths))
    if not closed.outcome.ok:
        raise ComputationFailed(closed.outcome)
