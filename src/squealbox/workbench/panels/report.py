"""The report of the present design as one HTML file, the same that `squealbox report` writes."""

from squealbox.design import Design
from squealbox.workbench.panels.declared import Panel
from squealbox.workbench.panels.panel import Answer, Options, Work

PANEL = Panel("Report", questions=("tells",), slow=True, apart=True)

PARTS = 11  # of an examination, and writing


def answer(design: Design, options: Options, work: Work) -> Answer:
    """The text of the HTML file, with the design as a file inside it."""
    from squealbox.report import design_page, examine, render

    done = 0

    def progress(text: str) -> None:
        nonlocal done
        work.progress(min(done / PARTS, 0.95), text)
        done += 1

    found = examine(design, progress=progress)
    progress("drawing")
    again = "squealbox report design.toml   # the file above, saved under that name"
    html = render(design_page(found, title=design.title, command=again))
    work.progress(0.99, "done")
    return Answer({"html": html, "missing": list(found.missing)})
