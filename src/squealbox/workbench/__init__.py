"""The workbench in the browser: a page on the user's own machine. Depends on: every analysis, files, plots.

    squealbox lab                    the page, with the drum brake of the 2011 paper
    squealbox lab brake.toml         the page, with a design file
    squealbox lab bench7             the page, in the project of that folder

Each question carries the design it is about; what is kept is in the project, plain files in a folder.
`docs/workbench.md` says how a panel is added: one Python file in ``panels/``, and a script in ``static/panels/`` where
one does more than show.
"""

from squealbox.workbench.lab import serve

__all__ = ["serve"]
