"""What the eigenvalues of steady sliding say to each claim of the paper."""

from typing import Any

import numpy as np

from squealbox.papers.drum_brake_2011 import steady
from squealbox.papers.drum_brake_2011.cases import LOAD, RESOLUTION, SPEED, Case
from squealbox.papers.drum_brake_2011.claims import Finding
from squealbox.papers.drum_brake_2011.steady import Onset, PressureMap, frequencies, growth, modes

STUDIED_LOADS = (LOAD, 25e3)  # N
CONSTANT_AMPLITUDE_SPEEDS = (0.12, 0.10, 0.08, 0.05)  # m/s, where the paper sees the amplitude constant
LOWEST_SPEED = 0.001  # m/s
ZONE = ((115.0, 155.0), (20.0, 40.0))  # deg, the published unstable zone in theta1 and theta2

Findings = dict[str, Finding]


def findings(case: Case, pressure: PressureMap) -> Findings:
    """All findings of this road, by ``claim.part``; `pressure` is the map of the same case."""
    friction, bare = steady.onset_in_friction(case), steady.onset_in_friction(case.replace(alpha=0.0))
    load = steady.onset_in_load(case)
    return {
        **_onset_in_friction(case, friction),
        **_frequencies_over_friction(case),
        **_load(case, load),
        **_speed(case),
        **_map(pressure),
        **_slope(case, friction, bare),
        **_mechanisms(case, friction, load),
    }


def _onset_in_friction(case: Case, onset: Onset) -> Findings:
    rate = growth(case.design(mu=np.arange(10, 40) / 100.0))
    why = onset.feeding or f"no onset up to mu = {steady.MU_RANGE[1]:g}"
    return {
        "mu-1.stable": Finding(bool(np.all(rate < 0.0)), f"largest growth rate {np.max(rate):.4g} 1/s"),
        "mu-2.onset": Finding(onset.value, "" if onset.exists else why),
        "mu-2.mechanism": Finding(onset.mechanism == "flutter", why),
    }


def _frequencies_over_friction(case: Case) -> Findings:
    near = modes(case, mu=np.array([0.10, 0.39, 0.40, 0.50]))
    both, rate = frequencies(near), near.growth_rate[..., :2]
    apart = np.diff(both)[..., 0]
    found = {
        "mu-3.lower": Finding(float(both[0, 0])),
        "mu-3.upper": Finding(float(both[0, 1])),
        "mu-4.separation": Finding(float(apart[1])),
        "mu-5.coalesced": Finding(bool(apart[2] < RESOLUTION), f"{apart[2]:.0f} rad/s apart"),
    }
    for key, i in (("mu-5.frequency", 2), ("mu-6.frequency", 3)):
        most = int(np.argmax(rate[i]))
        found[key] = Finding(float(both[i, most]), f"growth rate {rate[i, most]:.4g} 1/s")
    return found


def _load(case: Case, onset: Onset) -> Findings:
    at = modes(case, load=15e3)
    (lower, upper), rate = frequencies(at), at.growth_rate[:2]
    note = f"no onset up to {steady.LOAD_RANGE[1] / 1e3:g} kN"
    return {
        "N-1.onset": Finding(onset.value / 1e3, "" if onset.exists else note),
        "N-2.lower": Finding(float(lower), f"growth rate {rate[0]:.4g} 1/s"),
        "N-2.upper": Finding(float(upper), f"growth rate {rate[1]:.4g} 1/s"),
        "N-2.which": Finding(bool(rate[0] > 0.0 > rate[1]), f"growth rates {rate[0]:.4g} and {rate[1]:.4g} 1/s"),
    }


def _speed(case: Case) -> Findings:
    rate = growth(case.design(speed=np.array([SPEED, *CONSTANT_AMPLITUDE_SPEEDS])))
    note = f"growth rate {rate[0]:.4g} 1/s at {SPEED:g} m/s and {rate[-1]:.4g} 1/s at 0.05 m/s"
    return {"V-1.undamped": Finding(bool(rate[0] < 0.0 and np.all(rate[1:] >= 0.0)), note)}


def _map(pressure: PressureMap) -> Findings:
    from scipy.ndimage import label

    (low1, high1), (low2, high2) = ZONE
    first, second = pressure.angles[:, None], pressure.angles[None, :]
    zone = (first >= low1) & (first <= high1) & (second >= low2) & (second <= high2)
    unstable = pressure.unstable
    inside, share = float(np.mean(unstable[zone])), float(np.mean(unstable))
    found = {
        "th-1.zone": Finding(inside > 0.5, f"{inside:.0%} of the published zone is unstable"),
        "th-1.mostly_stable": Finding(0.0 < share < 0.5, f"{share:.1%} of the map is unstable"),
    }
    regions, count = label(unstable)
    covered = [int(np.sum(zone & (regions == i))) for i in range(1, count + 1)]
    names = ("theta1_from", "theta1_to", "theta2_from", "theta2_to")
    if not any(covered):
        missing = Finding(np.inf, "nothing in the published zone is unstable")
        return found | {f"th-1.{name}": missing for name in names}
    rows, columns = np.nonzero(regions == 1 + int(np.argmax(covered)))
    edges = (rows.min(), rows.max(), columns.min(), columns.max())
    return found | {f"th-1.{name}": Finding(float(pressure.angles[i])) for name, i in zip(names, edges, strict=True)}


def _slope(case: Case, onset: Onset, bare: Onset) -> Findings:
    if case.alpha == 0.0:
        nothing = Finding(None, "this run has no slope")
        return {"q-1.raises": nothing, "q-1.frequency": nothing}
    if not bare.exists:
        without = Finding(None, "there is no flutter to be shifted")
        return {"q-1.raises": without, "q-1.frequency": without}
    note = f"critical mu {bare.value:.4g} without the slope, {onset.value:.4g} with it"
    most: list[Any] = [modes(each, mu=0.50).most_unstable for each in (case, case.replace(alpha=0.0))]
    if all(mode.growth_rate > 0.0 for mode in most):
        shift = Finding(most[0].angular_frequency - most[1].angular_frequency)
    else:
        shift = Finding(None, "with or without the slope there is no flutter at mu = 0.50")
    return {"q-1.raises": Finding(onset.value > bare.value, note), "q-1.frequency": shift}


def _mechanisms(case: Case, friction: Onset, load: Onset) -> Findings:
    return {
        "q-2.grows": _grows(case, friction),
        "q-2.load": _set_off_by_load(load),
        "q-2.low_speed": _set_off_by_low_speed(case),
        "q-2.apart": Finding(
            load.separation > RESOLUTION if load.exists else None,
            f"{load.separation:.0f} rad/s apart" if load.exists else "there is no critical load",
        ),
    }


def _grows(case: Case, onset: Onset) -> Finding:
    if onset.value >= 0.50:
        return Finding(False, "no instability up to mu = 0.50")
    rate = growth(case.design(mu=np.linspace(onset.value, 0.50, 51)))
    return Finding(bool(np.all(np.diff(rate) > 0.0)), f"growth rate {rate[-1]:.4g} 1/s at mu = 0.50")


def _set_off_by_load(onset: Onset) -> Finding:
    low, high = STUDIED_LOADS
    if not onset.exists:
        return Finding(False, f"no onset up to {steady.LOAD_RANGE[1] / 1e3:g} kN")
    note = f"onset at {onset.value / 1e3:.4g} kN, {onset.feeding}"
    return Finding(low < onset.value <= high and onset.mechanism == "negative_slope", note)


def _set_off_by_low_speed(case: Case) -> Finding:
    speeds = np.linspace(LOWEST_SPEED, SPEED, 200)
    rate = growth(case.design(speed=speeds))
    note = f"growth rate {rate[-1]:.4g} 1/s at {SPEED:g} m/s, {rate[0]:.4g} 1/s at {LOWEST_SPEED:g} m/s"
    return Finding(bool(rate[-1] < 0.0 and np.any(rate > 0.0)), note)
