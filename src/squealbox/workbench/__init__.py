"""The workbench in the browser: a page on the user's own machine. Depends on: every analysis, files, plots.

    squealbox lab                    the page, with the drum brake of the 2011 paper
    squealbox lab brake.toml         the page, with a design file

The server keeps nothing of a user: each question carries the design it is about. `docs/workbench.md` says how a panel
is added: one Python file in ``panels/``, one ES module in ``static/panels/``.
"""

from squealbox.workbench.lab import serve

__all__ = ["serve"]
