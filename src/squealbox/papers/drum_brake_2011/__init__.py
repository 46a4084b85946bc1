"""The drum-brake paper of 2011, computed again: every figure, and every claim beside what this program finds.

    from squealbox.papers.drum_brake_2011 import reproduce

    reproduce("out")

Depends on: designs, stability, transient, signals, studies, plots, report.
"""

import os
from collections.abc import Callable
from pathlib import Path

__all__ = ["reproduce"]


def reproduce(
    out: str | os.PathLike[str],
    progress: Callable[[str, float], None] | None = None,
    fine: bool = False,
    search: bool = False,
) -> Path:
    """Write the whole study to the folder `out` and return its page, ``out/index.html``.

    `out` then holds index.html (self-contained), claims.json, claims.md and figures/ with Figs. 1 to 9 of the default
    reading, the other readings' in folders of their names, as PNG. `progress` is called with what was done and the
    share that is done. `fine` draws the maps of the centres of pressure by transients at 561 x 561 points in the place
    of 141 x 141 and for every printed reading, those of friction with load and speed for reading eq3 as well, and all
    figures as SVG too. `search` goes through the whole family of equations in the place of its short form, in the
    folder ``out/search``, where a search that was stopped goes on; and over alpha, speed and floor in every reading,
    into search.csv. Takes under a minute on 2 processors from nothing, several minutes more with `fine` or `search`.

    Source: Journal of Vibroengineering 13(2), paper 632, June 2011.
    """
    from squealbox.papers.drum_brake_2011 import jobs
    from squealbox.papers.drum_brake_2011.cases import ALL_READINGS

    folder = Path(out)
    figures = folder / "figures"
    figures.mkdir(parents=True, exist_ok=True)
    whole = None
    if search:
        from squealbox.papers.drum_brake_2011.reconstruction import reconstruct

        whole = reconstruct(folder / "search", jobs.processors(), progress)
    studies, searched, told = jobs.everything(ALL_READINGS, figures, progress, fine, search, _prepare)
    from squealbox.papers.drum_brake_2011 import beside, page, record, search_results
    from squealbox.papers.drum_brake_2011.reading import save
    from squealbox.report import write_page

    extras = beside.extras(told, whole)
    found = record.records(studies)
    record.write_json(folder / "claims.json", found, searched, extras)
    record.write_markdown(folder / "claims.md", found)
    if searched:
        save(search_results.draw(searched), figures / "search")
        search_results.write_csv(folder / "search.csv", searched)
    return write_page(page.page(figures, studies, found, searched, extras), folder / "index.html")


def _prepare() -> None:
    """Import what the page is made with, a second while the workers already work."""
    from squealbox.papers.drum_brake_2011 import page  # noqa: F401
