"""Why claims are met or not: the theorems, the reconstruction with its chance, and what the solver of 2011 did."""

from pathlib import Path
from typing import Any

from squealbox.designs import READINGS
from squealbox.papers.drum_brake_2011 import family_search, theorems
from squealbox.papers.drum_brake_2011.beside import Extras
from squealbox.papers.drum_brake_2011.cases import INFERRED, RECONSTRUCTED
from squealbox.papers.drum_brake_2011.family_modes import CLAIMS
from squealbox.papers.drum_brake_2011.solver_2011 import MU, SETTINGS, UPTO, damping_of_the_table
from squealbox.report import Cell, Code, Picture, Points, Section, Table, Text

ALT = {
    "theorem_trace": "Mean frequency over the friction coefficient: mu-6 lies below the band all linear laws stay in.",
    "theorem_damping": "Difference of damping over load: no line from the table's value passes both arrows.",
    "theorem_speed": "Decay rate at 1 kN over the falling speed: it stays near 100 1/s, where V-1 asks for zero.",
    "theorem_onset": "Squared split of the frequencies over friction: the published points lead to 0.440, not 0.40.",
}


def excluded(folder: Path) -> tuple[Any, ...]:
    """Four theorems, each with its sentence and figure."""
    bound = theorems.trace_bounds()["mu-3 and N-2"]
    lowest = (0.5 * bound.low) ** 0.5
    texts = {
        "theorem_trace": (
            "The trace argument: mu-6 against mu-3 and mu-5",
            "Whatever the friction matrix is, if it grows in proportion to mu, the sum of the squared frequencies is a "
            f"straight line in mu. Through mu-3 and N-2 that line is at {lowest:.0f} rad/s or above at mu = 0.50; the "
            "paper prints 12190. Only a law with mu squared, or the frequency of a large cycle, could be there.",
        ),
        "theorem_damping": (
            "mu-5 and N-2 exclude each other",
            "In Eq. (3) friction leaves the mean square at 12981 rad/s, so 13140 at the onset can only be the upper of "
            "two nearly merged modes: it must be the less damped one, which needs c22 > c11 at 1 kN. At 15 kN the "
            "lower mode grows, which needs c22 < c11. Both change in proportion to the load from the table's "
            "212 - 218.",
        ),
        "theorem_speed": (
            "V-1 and N-1 exclude each other",
            "Load enters the damping in proportion. What is stable without load and at 10 kN (N-1) therefore keeps "
            "nine tenths of its decay at 1 kN, where V-1 sees none; and speed hardly enters at all.",
        ),
        "theorem_onset": (
            "The frequencies against the onset",
            "In Eq. (3) without slope the squared split of the frequencies is a parabola in mu. The table and the "
            f"published frequencies fix it, and its zero, the onset, is {theorems.onset_from_frequencies():.3f}. An "
            f"onset of 0.40 costs {theorems.least_miss():.0f} rad/s in one of the four frequencies at least.",
        ),
    }
    return tuple(
        Section(title, (Text(text), Picture(folder / f"{name}.png", ALT[name], ALT[name])))
        for name, (title, text) in texts.items()
    )


def reconstruction(more: Extras, own: list[str], pictures: Any) -> tuple[Any, ...]:
    """The inferred readings: what they are, how likely such a match is, and the paper's figures redrawn."""
    rows = tuple(
        (
            Cell(f"{name}*", what),
            f"{-READINGS[name].slope:g} s/m",
            f"{READINGS[name].sliding_speed:g} m/s",
            "peak to peak",
        )
        for name, what in zip(INFERRED, WHAT, strict=True)
    )
    signs, by_chance, searched, whole = more.signs, more.by_chance, more.short, more.whole
    words = " or ".join(", ".join("+" if s > 0 else "-" for s in family_search.SIGNS[i]) for i in signs)
    structure = (
        f"One structural finding: of the sixteen combinations of sign that friction can have in Eq. (3), exactly "
        f"{len(signs)} ({words} with the sign of sliding) meets the onset, both frequencies at mu = 0.1 and at "
        f"0.3 and the distance before the onset. Scrambled numbers are met as well in {by_chance:.0%} of the cases."
    )
    return (
        Text(
            "What was run in 2011? These two readings are inferred from the published numbers, not printed anywhere. "
            "They differ from Eq. (3) with signed sliding in one sign: friction in the y row is +, - and not -, +, "
            "which is what friction that drags the drum along the belt asks for with sgn(V_B sin theta - y')."
        ),
        Table(("reading", "alpha", "V_B", "amplitudes"), rows, "*: inferred. Both were fitted."),
        Code(EQUATIONS),
        Text(structure),
        Text(_chance(searched, "the short form, belts as printed, made for this page")),
        *((Text(_chance(whole.searched, "the whole family")), *_outcome(whole, own)) if whole is not None else (
            Text("The whole family, and the transients of its best members, are gone through by: squealbox paper "
                 "drum-brake-2011 --search. This page then shows its counts and its chance level."),
        )),
        Text("So a match of this quality is suggestive and no proof."),
        Section(f"The paper's figures by {RECONSTRUCTED}*, to lay the paper beside", pictures),
    )  # fmt: skip


WHAT = (
    "the best: N enters friction so that the damping is Eq. (3)'s, with its +- read as -, +",
    "its simple sister: no N in friction, loads along the springs, round numbers",
)
EQUATIONS = """\
s, c: sin and cos of theta1, theta2
mu(v) = mu0 - alpha |v|

reconstructed
x: ... = -N1 s1 + N2 s2
       + mu (k3 y + N) c1^2 sgn(V c1 - x')
       - mu (k4 y - N) c2^2 sgn(V c2 - x')
y: ... = -N1 c1 + N2 c2
       + mu (k3 x - N) s1^2 sgn(V s1 - y')
       - mu (k4 x - N) s2^2 sgn(V s2 - y')

reconstructed_simple
x: ... = -N1 s1 - N2 s2
       + mu k3 c1^2 y sgn(V c1 - x')
       - mu k4 c2^2 y sgn(V c2 - x')
y: ... = -N1 c1 - N2 c2
       + mu k3 s1^2 x sgn(V s1 - y')
       - mu k4 s2^2 x sgn(V s2 - y')"""


def _chance(found: Any, name: str) -> str:
    counts = ", ".join(f"{number} meet {i}" for i, number in enumerate(found.counts) if number and i > 3)
    return (
        f"The search ({name}): {found.family:,} members, eight claims that eigenvalues decide ({', '.join(CLAIMS)}). "
        f"The best meet {found.most} ({counts}). Of {found.sets} sets of scrambled numbers, physical and as many, the "
        f"same search of {found.chance_family:,} members meets at least as many in {found.chance:.0%}."
    )


def _outcome(whole: Any, own: list[str]) -> tuple[Any, ...]:
    """What the best members of the whole search meet, beside what the reconstruction meets: ties and better ones."""
    ties = whole.ties
    most = len(ties[0][2])
    if most > len(own):
        against = (
            f"That is more than {RECONSTRUCTED}* meets ({len(own)}): by these numbers the first of them is the better "
            "reading."
        )
    elif most == len(own):
        against = f"{RECONSTRUCTED}* meets as many: the paper's numbers do not tell these equations apart."
    else:
        against = f"{RECONSTRUCTED}* meets more ({len(own)}); it lies between the members that were judged."
    choices: dict[tuple[str, ...], list[Any]] = {}
    for row, measure, ids in ties:
        choices.setdefault((*family_search.signs_of(row), measure, ", ".join(ids)), []).append(row)
    rows = tuple(
        (
            ", ".join(choice[:3]), choice[3], f"{len(members)}",
            _range([row[4] for row in members]), _range([row[5] for row in members]), choice[4], choice[5],
        )
        for choice, members in choices.items()
    )  # fmt: skip
    head = ("signs: front, belts, loads", "N in friction", "members", "alpha [s/m]", "V_B [m/s]", "amplitudes", "meets")
    caption = f"The members that meet {most} of the fifteen claims, by their choice of signs: none is left out."
    return (
        Text(
            f"{whole.tried[0]:,} of the best members, mirror images left out, and {whole.tried[1]:,} on the finer grid "
            f"were run for mu-7; {whole.meeting} come near it, {len(whole.rows)} were judged by all fifteen claims. "
            f"The most that one meets is {most}, met by {len(ties)} members of {len(choices)} choices. {against}"
        ),
        Table(head, rows, caption),
    )


def _range(values: list[float]) -> str:
    low, high = min(values), max(values)
    return f"{low:.4g}" if low == high else f"{low:.4g} to {high:.4g}"


def solver(folder: Path, more: Extras) -> tuple[Any, ...]:
    """What the solver of 2011 did to the motion, and where its damping comes from."""
    onsets = more.onsets
    rows = tuple(
        (
            Cell(each.setting, SETTINGS[each.setting]), _both(each.early), _both(each.late), f"{each.steps}",
            f"{onsets[each.setting][0] / 1e3:g} kN", f"{onsets[each.setting][1]:g}",
        )
        for each in more.decays
    )  # fmt: skip
    exact, plain = more.decays[0], more.decays[-1]
    times = [b / a for a, b in zip(exact.late, plain.late, strict=True)]
    (_, own), (_, none) = more.added.items()
    widest = [f"{rates[0][0]:.0f} to {rates[-1][1]:.0f}" for rates in (own, none)]
    table = damping_of_the_table()
    c = tuple((name, *(f"{value:.1f}" for value in pair)) for name, pair in table.items())
    return (
        Points((
            f"The paper's own method at its usual settings damps: it adds {widest[0]} 1/s to the decay of a mode over "
            f"the first 10 to 15 ms, and {widest[1]} 1/s without the slope, where both decay at 107 1/s.",
            f"As the motion dies, the error it allows does not: from 12.5 to 25 ms it decays {min(times):.1f} to "
            f"{max(times):.1f} times as fast as in truth.",
            "That moves the onset in load, where growth is slow, and hardly that in friction, where it is fast.",
            "c1 and c2 are 0.05 sqrt(k m), not what a loss factor of 0.02 gives.",
        )),
        Picture(folder / "solver.png", f"x at mu = {MU:.2f} by {RECONSTRUCTED}*: exact, and by the solver of 2011."),
        Table(("motion", "decay to 12.5 ms", "decay to 25 ms", "steps", "squeals from load", "squeals from mu"), rows,
              f"Reading {RECONSTRUCTED}*; runs of 0.05 s from rest, mu = {MU:.2f} and 1 kN for the decay, in 1/s, of "
              "the lower / upper mode."),
        Table(
            ("added to the decay [1/s]", *(f"first {1e3 * end:g} ms" for end in UPTO)),
            tuple((f"alpha = {alpha:g} s/m", *(_both(pair) for pair in rates)) for alpha, rates in more.added.items()),
            f"By ode23, lower / upper mode at mu = {MU:.2f} and 1 kN, with the slope of {RECONSTRUCTED}* and none.",
        ),
        Table(("damping [N s/m]", "c1", "c2"), c, "Where the table's damping comes from."),
    )  # fmt: skip


def _both(pair: tuple[float, float]) -> str:
    return " / ".join(f"{each:.0f}" for each in pair)
