"""`squealbox report`: a design or a result as one HTML page."""

import dataclasses
from pathlib import Path

from squealbox.cli.inputs import free, read
from squealbox.cli.options import AS_WRITTEN, Asked
from squealbox.cli.running import UsageError
from squealbox.report import ReportError
from squealbox.report import report as write
from squealbox.result import ResultFileError
from squealbox.waiting import Progress

ABOUT = {"report": "a design examined from every side, or any result, as one HTML page"}


def report(source: Path, *, out: Path | None = None, asked: Asked = AS_WRITTEN) -> None:
    """Write one HTML page that opens anywhere, prints well and needs no network.

    Of a design file: verdict, margin, parameters, stability, map, transient with sound, limit cycle, caveats and
    versions. Of a result, or a folder of them such as --out DIR and a study leave: what it holds.

    Parameters
    ----------
    source
        a design file (.toml), a result (.nc) or a folder of results
    out
        the HTML file; by default named after the source, in the current folder
    """
    target = out if out is not None else Path(f"{source.resolve().name.removesuffix(source.suffix)}.html")
    free(target)
    if asked.changes and source.suffix.lower() != ".toml":
        raise UsageError(f"--set {asked.changes[0][:60]}: only a design file can be changed, and {source} is none")
    what = read(source, asked) if source.suffix.lower() == ".toml" and source.is_file() else source
    if asked.changes and not isinstance(what, Path):
        what = dataclasses.replace(what, path=Path(f"{source.name} with {', '.join(asked.changes)}"))
    try:
        with Progress("examining") as progress:
            written = write(what, target, allow_code=asked.allow_code, progress=progress)
    except (ReportError, ResultFileError) as error:
        raise UsageError(str(error)) from error
    print(f"written: {written} ({written.stat().st_size / 1e6:.1f} MB)")
