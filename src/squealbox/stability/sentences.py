"""What stability says in sentences: the same words in the report and on the page.

>>> from squealbox import DrumBrake, complex_modes
>>> headline(complex_modes(DrumBrake()), None)
'Steady sliding is stable'
"""

from collections.abc import Callable

from squealbox.stability.eigenvalues import ComplexModes
from squealbox.stability.mechanisms import Mechanism
from squealbox.stability.onset import CriticalValues
from squealbox.words import AUDIBLE, number, quantity

MECHANISMS = {
    "flutter": "mode coupling (flutter)",
    "negative_slope": "falling friction (negative slope)",
    "divergence": "divergence",
    "mixed": "mode coupling and falling friction together",
    "unknown": "a mechanism that is not known",
}
LINEAR = (
    "Growth rates are linear and about steady sliding: they say whether squeal can start, not how loud it gets; stable "
    "sliding can still squeal after a push."
)
MERGE = "Two modes nearly merge here: growth rates and shares react strongly to small changes, derivatives mean little."
UNDAMPED = 1e-9  # damping ratio below which what is left is round-off
Words = list[str | tuple[str, bool]]  # texts, those with True to be seen first


def headline(modes: ComplexModes, why: Mechanism | None) -> str:
    """The answer in a line; `why` is the mechanism, None where it is not known."""
    if not bool(modes.exists):
        return "No steady sliding"
    if bool(modes.stable):
        return "Steady sliding is stable"
    if why is not None and why.name == "divergence":
        return "Unstable: it moves away without vibrating"
    frequency = modes.most_unstable.frequency
    heard = AUDIBLE[0] <= frequency <= AUDIBLE[1]
    return f"Unstable: it will {'squeal' if heard else 'vibrate'} at about {quantity(frequency, 'Hz')}"


def growth_in_words(modes: ComplexModes, why: Mechanism | None) -> str:
    """How fast the first mode grows or the last one decays, and what feeds it."""
    if not bool(modes.exists):
        return f"{modes.outcome.message}."
    worst = modes.most_unstable
    if why is not None and not bool(modes.stable):
        several = min(int(modes.unstable_modes), modes.eigenvalues.shape[-1] // 2)
        grow = f"{several} modes grow, the fastest" if several > 1 else "One mode grows,"
        fed = f", {100.0 * why.flutter_share:.0f} % of what feeds it from circulation"
        known = why.name != "divergence" and why.flutter_share == why.flutter_share
        return (
            f"{grow} at {number(worst.growth_rate)} 1/s by {MECHANISMS.get(why.name, why.name)}{fed if known else ''}."
        )
    if abs(worst.damping_ratio) < UNDAMPED:
        return f"A mode at {quantity(worst.frequency, 'Hz')} neither grows nor decays: nothing in the model damps it."
    return (
        f"The least damped mode decays at {number(-worst.growth_rate)} 1/s, at {quantity(worst.frequency, 'Hz')} "
        f"(damping ratio {number(worst.damping_ratio, 3)})."
    )


def margin_in_words(
    parameter: str,
    here: float | None,
    found: CriticalValues,
    ends: tuple[float, float],
    worded: Callable[[float], str],
) -> Words:
    """Where stability changes over a parameter and how far the design is from there; `worded` writes an SI value."""
    changes = found.changes
    if not changes:
        return [f"Over {parameter} from {worded(ends[0])} to {worded(ends[1])} that does not change."]
    if here is None:
        return [f"Critical {parameter}: {', '.join(worded(float(each.value)) for each in changes)}."]
    near = found.nearest(here) or changes[0]
    value = float(near.value)
    away = f" ({number(100.0 * (value - here) / abs(here), 3)} %)" if here else ""
    way = "above" if value >= here else "below"
    hertz = "" if near.mechanism == "divergence" else f" at {quantity(near.frequency, 'Hz')}"
    words: Words = [
        "Stability changes at ",
        (f"{parameter} = {worded(value)}", True),
        f", {worded(abs(value - here))} {way} the present {worded(here)}{away}, by "
        f"{MECHANISMS.get(near.mechanism, near.mechanism)}{hertz}.",
    ]
    if len(changes) > 1:
        words.append(f" It changes {len(changes)} times in this range.")
    return words


def plain_words(words: Words) -> str:
    """The words as one text."""
    return "".join(each if isinstance(each, str) else each[0] for each in words)
