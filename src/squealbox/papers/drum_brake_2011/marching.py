"""The march of `solver_2011.ode23`, plain functions for `compiled`."""

import numpy as np

# linear, force, sensed, pushed, laws
Equation = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]


def march(
    equation: Equation, duration: float, rtol: float, shortest: float, times: np.ndarray, states: np.ndarray,
    slopes: np.ndarray, room: np.ndarray,
) -> int:  # fmt: skip
    """Count k of the accepted steps of Bogacki and Shampine's method, from rest; one more than there is room for if so.

    equation : linear (n, 2n) and force (n,) give q'' without contacts, sensed (contacts, 2n) the rows n and t of each,
        pushed (contacts, n) what its force adds to q'', laws its N0, V, mu0 and slope

    Instants and states go to `times` and `states` (..., 2n); `slopes` (4, 2n) and `room` (3, 2n) are zeros to work in.
    """
    y, new, largest = room[0], room[1], room[2]
    size = len(y) // 2
    for i in range(2 * size):
        largest[i] = 1e-6 / rtol
    _rate(equation, y, slopes[0])
    time, step, failed, count = 0.0, 1e-6, False, 1
    times[0] = time
    for i in range(2 * size):
        states[0, i] = y[i]
    while time < duration:
        step = min(step, duration / 50.0, duration - time)
        for i in range(2 * size):
            new[i] = y[i] + 0.5 * step * slopes[0, i]
        _rate(equation, new, slopes[1])
        for i in range(2 * size):
            new[i] = y[i] + 0.75 * step * slopes[1, i]
        _rate(equation, new, slopes[2])
        for i in range(2 * size):
            new[i] = y[i] + step / 9.0 * (2.0 * slopes[0, i] + 3.0 * slopes[1, i] + 4.0 * slopes[2, i])
        _rate(equation, new, slopes[3])
        worst = 0.0
        for i in range(2 * size):
            error = -5.0 * slopes[0, i] / 72.0 + slopes[1, i] / 12.0 + slopes[2, i] / 9.0 - slopes[3, i] / 8.0
            worst = max(worst, step * abs(error) / max(abs(y[i]), abs(new[i]), largest[i]))
        wanted = 0.8 * (rtol / max(worst, 1e-12)) ** (1.0 / 3.0)
        if worst > rtol and step > shortest:
            step *= 0.5 if failed else max(0.5, wanted)
            failed = True
            continue
        time, failed = time + step, False
        for i in range(2 * size):
            y[i], slopes[0, i] = new[i], slopes[3, i]
            largest[i] = max(largest[i], abs(y[i]))
        if count == len(times):
            return count + 1
        times[count] = time
        for i in range(2 * size):
            states[count, i] = y[i]
        count += 1
        step *= min(5.0, wanted)
    return count


def _rate(equation: Equation, y: np.ndarray, out: np.ndarray) -> None:
    """The rate of change of (q, q')."""
    linear, force, sensed, pushed, laws = equation
    size = len(force)
    for i in range(size):
        out[i] = y[size + i]
        out[size + i] = force[i]
        for j in range(2 * size):
            out[size + i] += linear[i, j] * y[j]
    for c in range(len(laws)):
        pressed, v = laws[c, 0], laws[c, 1]
        for j in range(size):
            pressed += sensed[c, j] * y[j]
            v -= sensed[c, size + j] * y[size + j]
        mu = laws[c, 2] + laws[c, 3] * abs(v)  # Eq. (2)
        for i in range(size):
            out[size + i] += np.sign(v) * mu * pressed * pushed[c, i]
