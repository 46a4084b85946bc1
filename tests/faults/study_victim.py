"""A sweep as a program that can be killed: python study_victim.py FOLDER JOURNAL [workers N | scheduler ADDRESS].

Every point it computes is written to the journal at once, so that one can see what was computed twice.
"""

import os
import sys
import time

import numpy as np

POINTS, CHUNK = 500, 5
LOADS = np.arange(POINTS, dtype=float)
PACE = 0.002  # seconds for a point
JOURNAL = "SQUEALBOX_JOURNAL"


def answer(design):
    """A number, a row and a word that only this point has."""
    with open(os.environ[JOURNAL], "ab", buffering=0) as journal:
        journal.write(f"{int(design.load1)}\n".encode())
    time.sleep(PACE)
    return {
        "root": np.sqrt(design.load1),
        "row": np.sin(design.load1 + np.arange(3)),
        "word": str(int(design.load1) % 7),
    }


def study(folder, **how):
    """The sweep."""
    from squealbox import DrumBrake
    from squealbox.studies import sweep

    return sweep(DrumBrake(), {"load": LOADS}, answer, out=folder, chunk=CHUNK, **how)


if __name__ == "__main__":
    folder, os.environ[JOURNAL], *kind = sys.argv[1:]
    found = study(folder, **({kind[0]: int(kind[1]) if kind[0] == "workers" else kind[1]} if kind else {}))
    print(found.outcome)
