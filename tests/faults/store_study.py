"""A small study, the same under one name for every process that runs it."""

import numpy as np

SPACE = {"load": np.arange(20.0)}


def answer(design):
    """A number and a word."""
    return {"a": np.sqrt(design.load1), "word": "odd" if design.load1 % 2 else "even"}


def go_on(folder, **how):
    """The study, from where the folder has it."""
    from squealbox import DrumBrake
    from squealbox.studies import sweep

    return sweep(DrumBrake(), SPACE, answer, out=folder, chunk=4, **how)
