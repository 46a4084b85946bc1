"""`squealbox report`: a design or a result as one HTML page."""

import dataclasses
from pathlib import Path

from squealbox.cli.inputs import Changes, free, read
from squealbox.cli.options import AllowCode
from squealbox.cli.running import UsageError
from squealbox.report import ReportError
from squealbox.report import report as write
from squealbox.result import ResultFileError
from squealbox.waiting import Progress

ABOUT = {"report": "a design examined from every side, or any result, as one HTML page"}


def report(source: Path, *, out: Path | None = None, changes: Changes = (), allow_code: AllowCode = False) -> None:
    """Write one HTML page that opens anywhere, prints well and needs no network.

    Of a design file: verdict, margin, parameters, stability, map, transient with sound, limit cycle, caveats and
    versions. Of a result, or a folder of them such as --out DIR and a study leave: what it holds.

    Parameters
    ----------
    source
        a design file (.toml), a result (.nc) or a folder of results
    out
        the HTML file; by default named after the source, in the current folder
    changes
        other values for this report of a design file: --set friction.static=0.4
    allow_code
        run the Python file of a friction law that the design file names
    """
    target = out if out is not None else Path(f"{source.resolve().name.removesuffix(source.suffix)}.html")
    free(target)
    if changes and source.suffix.lower() != ".toml":
        raise UsageError(f"--set {changes[0][:60]}: only a design file can be changed, and {source} is none")
    what = read(source, changes, allow_code) if source.suffix.lower() == ".toml" and source.is_file() else source
    if changes and not isinstance(what, Path):
        what = dataclasses.replace(what, path=Path(f"{source.name} with {', '.join(changes)}"))
    try:
        with Progress("examining") as progress:
            written = write(what, target, allow_code=allow_code, progress=progress)
    except (ReportError, ResultFileError) as error:
        raise UsageError(str(error)) from error
    print(f"written: {written} ({written.stat().st_size / 1e6:.1f} MB)")
