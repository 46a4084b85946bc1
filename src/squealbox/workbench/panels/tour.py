"""A guided tour of the drum-brake paper of 2011: steps that set the design, and the verdicts on the paper's claims.

The verdicts are computed for the reading of the equations and the friction slope of the design that is shown, as
`squealbox paper drum-brake-2011` computes them for its readings.
"""

from functools import cache
from typing import Any

import numpy as np

from squealbox.designs import Design, DrumBrake
from squealbox.friction import LinearSlope
from squealbox.papers.drum_brake_2011.cases import ALPHA, SPEED, Case
from squealbox.papers.drum_brake_2011.claims import paper
from squealbox.papers.drum_brake_2011.record import count
from squealbox.papers.drum_brake_2011.verdicts import verdicts
from squealbox.workbench.panels.panel import Answer, OptionError, Options, Work

TABLE: dict[str, Any] = {"friction.static": 0.3, "load1": 1000.0, "load2": 1000.0, "sliding_speed": SPEED}
STEPS: tuple[dict[str, Any], ...] = (
    {
        "title": "The brake of the paper",
        "text": "A drum on two springs, held by two shoes at 35° and 115°. The values are those of the paper's table; only "
        "the slope of friction is not printed there and is assumed, 0.05 s/m.",
        "look": ["friction"],
        "values": {},
        "claims": [],
    },
    {
        "title": "Two modes, apart",
        "text": "At a friction coefficient of 0.1 the two modes are far apart and both decay. Compare the frequencies with "
        "the paper's.",
        "look": ["locus"],
        "values": {"friction.static": 0.1},
        "claims": ["mu-3"],
    },
    {
        "title": "They approach",
        "text": "With more friction the modes come closer. The paper finds steady sliding stable up to 0.39, with 560 rad/s "
        "between the modes and a beating motion.",
        "look": ["locus", "motion"],
        "values": {"friction.static": 0.39},
        "claims": ["mu-1", "mu-4"],
    },
    {
        "title": "Flutter",
        "text": "They meet, and one of them is fed by the circulation of the friction forces. In the paper that happens at "
        "0.40; the verdict above names the value this reading gives.",
        "look": ["locus", "energy"],
        "values": {"friction.static": 0.4},
        "claims": ["mu-2", "mu-5"],
    },
    {
        "title": "The limit cycle",
        "text": "Beyond the onset the motion grows until contacts stick. Its amplitude and frequency are claims too. Press "
        "Follow in the panel of limit cycles: a large cycle exists already where sliding is still stable.",
        "look": ["motion", "branch"],
        "values": {"friction.static": 0.5},
        "claims": ["mu-6", "mu-7"],
    },
    {
        "title": "More load",
        "text": "At a friction of 0.3 the load is raised to 15 kN. Now the falling friction feeds a mode: negative slope, not "
        "flutter.",
        "look": ["map", "motion"],
        "values": {"load1": 15e3, "load2": 15e3},
        "claims": ["N-1", "N-2", "N-3"],
    },
    {
        "title": "Braking to a stop",
        "text": "The paper slows the belt down from 0.2 m/s. Here the speed stands at 0.05 m/s, the end of the stretch in which "
        "the paper sees a constant amplitude; the claims are judged on the whole braking.",
        "look": ["motion", "friction"],
        "values": {"sliding_speed": 0.05},
        "claims": ["V-1", "V-2"],
    },
    {
        "title": "Where the shoes press",
        "text": "The map over both centres of pressure. The paper finds it unstable for theta1 from 115° to 155° with theta2 "
        "from 20° to 40°, and mostly stable elsewhere.",
        "look": ["map"],
        "values": {},
        "map": {"x": "theta1", "y": "theta2"},
        "claims": ["th-1"],
    },
    {
        "title": "Two mechanisms",
        "text": "The slope of friction shifts the onset and the frequency, and alone it can start a vibration at high load. Move "
        "friction.slope to zero and see what is left.",
        "look": ["sensitivity", "energy"],
        "values": {"friction.static": 0.45},
        "claims": ["q-1", "q-2"],
    },
    {
        "title": "Another reading",
        "text": "The paper's equations contradict each other. Eq. (3) as printed gives other numbers: choose a reading and judge "
        "again. No reading meets all claims, and none was tuned.",
        "look": ["locus"],
        "values": {"reading": "eq3", "friction.static": 0.45},
        "claims": ["mu-1", "mu-2", "mu-3", "mu-6"],
    },
)  # fmt: skip


def answer(design: Design, options: Options, work: Work) -> Answer:
    """The verdict on each claim for the reading and slope of this design."""
    if not isinstance(design, DrumBrake) or not isinstance(design.friction, LinearSlope):
        raise OptionError("the claims are about the drum brake with a linear slope of friction: start the tour")
    slope = float(np.asarray(design.friction.slope))
    case = Case(design.reading, alpha=-slope)
    found = _kept(case) if case in _READY else verdicts(case, work.progress)
    _READY[case] = found
    claims = [
        {"id": each["id"], "statement": each["statement"], "published": each["published"], "verdict": each["verdict"],
         "computed": each["computed"]} for each in found
    ]  # fmt: skip
    return Answer({
        "reading": design.reading,
        "alpha": -slope,
        "assumed": abs(-slope - ALPHA) < 1e-12,
        "claims": claims,
        "count": count(found),
        "title": paper()["title"],
        "source": paper()["source"],
    })  # fmt: skip
