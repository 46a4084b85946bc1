"""What a lane needs besides its steps: the next job, the place of an event, new modes, samples; compiled by `kernel`.

These are scalar passes over one lane of a group. Modes are decided by the very functions of the scalar march, on a
record filled from the lane, so stick, slip and lift-off mean the same in both.
"""

# ruff: noqa: F821  (the places of the rows, FUNCTIONS, EXACT_CONTACT, TRIES, SERIES, SIMPLE, SAMPLES, gather, step and take are generated)
# mypy: disable-error-code="name-defined,no-untyped-def"

import numpy as np

from squealbox.transient._events import event_values
from squealbox.transient._march import (
    CHATTERING,
    COMPLETED,
    INCONSISTENT,
    MISSED,
    NOT_FINITE,
    RUNNING,
    STEP_LIMIT,
    TENSION,
    UNDERFLOW,
    ZENO,
    chatters,
    pulled,
)
from squealbox.transient._modes import apply_event, start_modes
from squealbox.transient._motion import (
    FLIPS,
    INSIDE,
    OPEN,
    REVERSALS,
    STEP,
    STICK,
    derivative,
    event_tolerance,
    force_noise,
    list_sticking,
)
from squealbox.transient._sharing import contact_matrix, share_out, solve, weigh_sticking
from squealbox.transient.lanes.alone import change_alone
from squealbox.transient.lanes.crossing import locate
from squealbox.transient.lanes.recording import first_row, log_event, room_left, series_held, write_rows
from squealbox.transient.lanes.samples import on_end, on_quintic, on_series, on_step

OVERFLOW = 1e200  # a state that large has a series beyond all numbers
TOO_LARGE = 1e30  # one whose error has an eighth power beyond them
DONE, LOST, OVER, EVENT, LANDED, DUE = 1, 2, 4, 8, 16, 32


def run(A, live, o):
    """Advance all groups until no job of the orders is left, or until o.stop[0] is set; `live` counts the busy lanes of
    each group.
    """
    groups = live.shape[0]
    size = A.shape[0] // groups
    if A[ROW_ALIVE * WIDTH] < 0.0:  # fresh arrays
        for g in range(groups):
            for lane in range(WIDTH):
                A[g * size + ROW_ALIVE * WIDTH + lane] = 0.0
                live[g] += refill(A, g * size, lane, o)
        if RECORDED and live[0] > 0:
            first_row(A, 0, 0, o)
    while True:
        busy = 0
        for _ in range(o.every):
            busy = 0
            for g in range(groups):
                if live[g] > 0:
                    if RECORDED and not room_left(o):
                        return False
                    busy += 1
                    flags = step(A, g * size)
                    if RECORDED and EXACT_CONTACT and not series_held(A, 0, o.p):
                        finish(A, 0, 0, MISSED, o.out)
                        return True
                    if flags != 0:
                        live[g] -= serve(A, g * size, flags, o)
            if busy == 0:
                return True
        if RECORDED or o.stop[0] != 0:
            return False


def serve(A, b, flags, o):
    """Look after every flagged lane; returns how many of them found no further job."""
    idle = 0
    for lane in range(WIDTH):
        if (flags >> lane) & 1 == 0:
            continue
        code = int(A[b + ROW_CODE * WIDTH + lane])
        if SAMPLES and code & DUE:
            write_samples(A, b, lane, o)
        if RECORDED and code & DUE:
            write_rows(A, b, lane, o)
        ended = RUNNING
        if code & LOST:
            ended = or_chattering(A, b, lane, UNDERFLOW, o) if is_finite(A, b, lane) else NOT_FINITE
        elif code & OVER and not code & DONE:
            ended = or_chattering(A, b, lane, STEP_LIMIT, o)
        elif EXACT_CONTACT and code & LANDED:
            ended = change_modes(A, b, lane, int(A[b + ROW_TARGET * WIDTH + lane]), o)
        elif TRIES and code & EVENT:
            which = locate(A, b, lane)
            if which >= 0:
                ended = change_modes(A, b, lane, which, o)
        elif code & DONE:
            ended = next_piece(A, b, lane, o)
        if ended != RUNNING:
            finish(A, b, lane, ended, o.out)
            idle += 1 - refill(A, b, lane, o)
    return idle


def or_chattering(A, b, lane, ended, o):
    """How a job ended that ran out of steps: as told, or because sliding reverses at most of them."""
    if STAGED:
        o.s.count[FLIPS] = int(np.ceil(A[b + ROW_FLIPS * WIDTH + lane]))
        o.s.count[REVERSALS] = int(A[b + ROW_REVERSALS * WIDTH + lane])
        o.s.clock[STEP] = A[b + ROW_H * WIDTH + lane]
        if chatters(o.p, o.s):
            return CHATTERING
    return ended


def is_finite(A, b, lane):
    """Whether the present state and its derivative are numbers: then the step was too small, not the motion lost."""
    total = 0.0
    for i in range(DOFS):
        total += abs(A[b + (ROW_Q + i) * WIDTH + lane]) + abs(A[b + (ROW_V + i) * WIDTH + lane])
        total += abs(A[b + (ROW_ACCELERATION + i) * WIDTH + lane])
    return total < (OVERFLOW if SERIES else TOO_LARGE)


def refill(A, b, lane, o):
    """Begin the next job in a lane; returns 0 when there is none. A job whose start has no modes ends at once."""
    while True:
        job = take(o.counter)
        if job >= o.total:
            A[b + ROW_ALIVE * WIDTH + lane] = 0.0
            return 0
        for row in range(GIVEN):
            A[b + row * WIDTH + lane] = o.table[job, o.varies[row]] if o.varies[row] >= 0 else o.fixed[3 + row]
        for row in range(GIVEN, ALL_ROWS):
            A[b + row * WIDTH + lane] = 0.0
        begin(A, b, lane, job, o)
        ended = start(A, b, lane, o.p, o.s)
        if ended == RUNNING:
            A[b + ROW_ALIVE * WIDTH + lane] = 1.0
            return 1
        finish(A, b, lane, ended, o.out)


def begin(A, b, lane, job, o):
    """Clock, counters, start and the observers' memory; fixed holds the end, the start and the cap, then the rows."""
    A[b + ROW_JOB * WIDTH + lane] = job
    A[b + ROW_T * WIDTH + lane] = o.fixed[1]
    A[b + ROW_MOST * WIDTH + lane] = o.fixed[2]
    A[b + ROW_H * WIDTH + lane] = A[b + ROW_FIRST * WIDTH + lane]
    A[b + ROW_T_END * WIDTH + lane] = piece_end(A, b, lane, o.fixed[0])
    for k in range(DOFS):
        A[b + (ROW_Q + k) * WIDTH + lane] = A[b + (ROW_START + k) * WIDTH + lane]
        A[b + (ROW_V + k) * WIDTH + lane] = A[b + (ROW_START + DOFS + k) * WIDTH + lane]
    for c in range(CONTACTS):
        A[b + (ROW_LOWEST + c) * WIDTH + lane] = np.inf
        A[b + (ROW_FASTEST + c) * WIDTH + lane] = 0.0
    set_observers(A, b, lane, o.fixed)
    if SAMPLES:
        A[b + ROW_NEXT_SAMPLE * WIDTH + lane] = o.times[0]
    if EXACT_CONTACT:
        A[b + ROW_TARGET * WIDTH + lane] = -1.0
        A[b + ROW_WINDOW_START * WIDTH + lane] = o.fixed[1]


def piece_end(A, b, lane, end):
    """The next kink of a schedule, or the end."""
    t = A[b + ROW_T * WIDTH + lane]
    first = end
    for k in range(BREAKS):
        at = A[b + (ROW_BREAK + k) * WIDTH + lane]
        if t < at < first:
            first = at
    return first


def start(A, b, lane, p, s):
    """Modes and accelerations at the start."""
    gather(A, b, lane, p, s)
    load_state(A, b, lane, p, s)
    t = A[b + ROW_T * WIDTH + lane]
    if EXACT_CONTACT and not start_modes(p, t, s.state, s.mode, s):
        return TENSION if pulled(p, s) else INCONSISTENT
    refresh(A, b, lane, t, p, s)
    return RUNNING


def next_piece(A, b, lane, o):
    """Go on behind a kink of a schedule, where a force that jumps may let a contact go; COMPLETED at the end."""
    t = A[b + ROW_T * WIDTH + lane]
    if t >= o.fixed[0]:
        return COMPLETED
    p, s = o.p, o.s
    A[b + ROW_T_END * WIDTH + lane] = piece_end(A, b, lane, o.fixed[0])
    gather(A, b, lane, p, s)
    load_state(A, b, lane, p, s)
    for c in range(CONTACTS):
        s.fresh[c] = 0
    refresh(A, b, lane, t, p, s)
    if EXACT_CONTACT:
        fastest = 0.0
        for c in range(CONTACTS):
            fastest = max(fastest, abs(s.speed[c]))
        for c in range(CONTACTS):  # its limit may have jumped, or a belt has just come to rest below it
            slips = s.mode[c] != STICK and s.mode[c] != OPEN
            rests = slips and abs(s.speed[c]) <= event_tolerance(p, c, s.state, s, 0.0) + 1e-12 * fastest
            if rests or (s.mode[c] == STICK and s.phi[c] < 0.0):
                A[b + ROW_RESUME * WIDTH + lane] = A[b + ROW_H * WIDTH + lane]
                A[b + (ROW_FORCE + c) * WIDTH + lane] = s.force[c]
                return change_modes(A, b, lane, c, o)
    return RUNNING


def load_state(A, b, lane, p, s):
    """State and modes of a lane into the records of the scalar march."""
    room = p.mk.shape[0]
    s.clock[INSIDE] = np.inf
    for i in range(DOFS):
        s.state[i] = A[b + (ROW_Q + i) * WIDTH + lane]
        s.state[room + i] = A[b + (ROW_V + i) * WIDTH + lane]
    if EXACT_CONTACT:
        for c in range(CONTACTS):
            s.bias[c] = 1.0
            s.mode[c] = (
                OPEN if A[b + (ROW_OPENED + c) * WIDTH + lane] > 0.0 else int(A[b + (ROW_SLIPS + c) * WIDTH + lane])
            )


def refresh(A, b, lane, t, p, s):
    """Velocities, accelerations, modes, event functions and the inverse of the sticking contacts, back into a lane."""
    room = p.mk.shape[0]
    derivative(p, t, s.state, s.mode, s, s.dy)
    for i in range(DOFS):
        if p.light:  # an algebraic row follows the others
            A[b + (ROW_Q + i) * WIDTH + lane] = s.state[i]
        A[b + (ROW_V + i) * WIDTH + lane] = s.state[room + i]
        A[b + (ROW_ACCELERATION + i) * WIDTH + lane] = s.dy[room + i]
    if STAGED:
        for c in range(CONTACTS):
            A[b + (ROW_NORMAL_END + c) * WIDTH + lane] = s.normal[c]
            A[b + (ROW_SPEED_END + c) * WIDTH + lane] = s.speed[c]
            A[b + (ROW_FRICTION_END + c) * WIDTH + lane] = s.force[c]
    if EXACT_CONTACT:
        hold_matrix(A, b, lane, p, s)
        event_values(p, t, s.state, s.mode, s, s.phi)
        for c in range(CONTACTS):
            A[b + (ROW_OPENED + c) * WIDTH + lane] = 1.0 if s.mode[c] == OPEN else 0.0
            A[b + (ROW_SLIPS + c) * WIDTH + lane] = 0.0 if s.mode[c] == OPEN else float(s.mode[c])
            A[b + (ROW_FRESH + c) * WIDTH + lane] = s.leave[c] if s.fresh[c] else 0.0
            A[b + (ROW_NOISE + c) * WIDTH + lane] = force_noise(p, c, s.state, s) if s.mode[c] == STICK else 0.0
            A[b + (ROW_PHI + c) * WIDTH + lane] = 0.0 if s.fresh[c] else s.phi[c]
            if FUNCTIONS > CONTACTS:
                A[b + (ROW_PHI + CONTACTS + c) * WIDTH + lane] = s.phi[p.contacts + c]


def hold_matrix(A, b, lane, p, s):
    """Rows H: the inverse of t . M^-1 d over the sticking contacts; where it is singular, `_sharing.share_out`."""
    for c in range(CONTACTS):
        for e in range(CONTACTS):
            A[b + (ROW_HOLD + c * CONTACTS + e) * WIDTH + lane] = 0.0
    sticking = list_sticking(p, s.mode, s)
    for e in range(sticking):
        for a in range(sticking):
            s.right[a] = 1.0 if a == e else 0.0
        contact_matrix(p, s, sticking)
        if not solve(s.matrix, s.right, sticking):
            for a in range(sticking):
                s.wanted[a] = 1.0 if a == e else 0.0
            weigh_sticking(p, s, sticking)
            share_out(s, sticking)
        for a in range(sticking):
            A[b + (ROW_HOLD + s.stuck[a] * CONTACTS + s.stuck[e]) * WIDTH + lane] = s.right[a]


def change_modes(A, b, lane, j, o):
    """An event of function j at the present state: new modes, and the bound on events in a window of time."""
    p, s, t = o.p, o.s, A[b + ROW_T * WIDTH + lane]
    done = False
    if SIMPLE:
        before = A[b + (ROW_SLIPS + j) * WIDTH + lane]
        done = change_alone(A, b, lane, j)
        if done and A[b + (ROW_SLIPS + j) * WIDTH + lane] != before:
            A[b + ROW_EVENTS * WIDTH + lane] += 1.0
            if RECORDED:
                log_event(A, b, lane, j, A[b + (ROW_SLIPS + j) * WIDTH + lane], o)
    if not done:
        gather(A, b, lane, p, s)
        load_state(A, b, lane, p, s)
        solved = apply_event(p, t, s.state, s.mode, s, j if j < CONTACTS else p.contacts + j - CONTACTS)
        for c in range(CONTACTS):
            if s.mode[c] != s.old[c]:
                A[b + ROW_EVENTS * WIDTH + lane] += 1.0
                if RECORDED:
                    log_event(A, b, lane, c, s.mode[c], o)
        if not solved:
            return TENSION if pulled(p, s) else INCONSISTENT
        opened = j >= CONTACTS or s.old[j] == OPEN or s.mode[j] == OPEN
        refresh(A, b, lane, t, p, s)
        if FUNCTIONS > CONTACTS and opened:  # N = 0 there: round-off of the other sign is no event of its own
            c = j if j < CONTACTS else j - CONTACTS
            at = c if s.mode[c] == OPEN else CONTACTS + c
            A[b + (ROW_PHI + at) * WIDTH + lane] = max(A[b + (ROW_PHI + at) * WIDTH + lane], 1e-300)
    A[b + ROW_H * WIDTH + lane] = A[b + ROW_RESUME * WIDTH + lane]
    A[b + ROW_TARGET * WIDTH + lane] = -1.0
    A[b + ROW_TRUST * WIDTH + lane] = 0.0
    if not SERIES:
        A[b + ROW_EASED * WIDTH + lane] = 0.0
    A[b + ROW_WINDOW_EVENTS * WIDTH + lane] += 1.0
    if t - A[b + ROW_WINDOW_START * WIDTH + lane] > A[b + ROW_WINDOW * WIDTH + lane]:
        A[b + ROW_WINDOW_START * WIDTH + lane] = t
        A[b + ROW_WINDOW_EVENTS * WIDTH + lane] = 0.0
    if A[b + ROW_WINDOW_EVENTS * WIDTH + lane] <= 40.0 * (CONTACTS + 1):
        return RUNNING
    gather(A, b, lane, p, s)
    load_state(A, b, lane, p, s)
    derivative(p, t, s.state, s.mode, s, s.dy)
    for c in range(CONTACTS):
        s.at_zero[c] = s.mode[c] == STICK or c == j
    return TENSION if pulled(p, s) else ZENO


def finish(A, b, lane, ended, out):
    """Write what a job leaves: how it ended, its clock and counts, its state and the observers' memory."""
    job = int(A[b + ROW_JOB * WIDTH + lane])
    out[job, 0] = ended
    out[job, 1] = A[b + ROW_T * WIDTH + lane]
    out[job, 2] = A[b + ROW_TAKEN * WIDTH + lane]
    out[job, 3] = A[b + ROW_TRIES * WIDTH + lane]
    out[job, 4] = A[b + ROW_EVENTS * WIDTH + lane] if EXACT_CONTACT else 0.0
    for k in range(2 * DOFS):
        out[job, 5 + k] = A[b + (ROW_Q + k) * WIDTH + lane]
    for k in range(MEMORY):
        out[job, 5 + 2 * DOFS + k] = A[b + (ROW_OBSERVED + k) * WIDTH + lane]
    for c in range(CONTACTS):
        out[job, 5 + 2 * DOFS + MEMORY + c] = A[b + (ROW_LOWEST + c) * WIDTH + lane]
        out[job, 5 + 2 * DOFS + MEMORY + CONTACTS + c] = A[b + (ROW_FASTEST + c) * WIDTH + lane]


def write_samples(A, b, lane, o):
    """State at the instants that lie in the step just taken."""
    job = int(A[b + ROW_JOB * WIDTH + lane])
    if STEPPED:
        gather(A, b, lane, o.p, o.s)
        load_state(A, b, lane, o.p, o.s)
    k = int(A[b + ROW_SAMPLE * WIDTH + lane])
    while k < o.times.shape[0] and o.times[k] <= A[b + ROW_T * WIDTH + lane]:
        if o.times[k] == A[b + ROW_T * WIDTH + lane]:
            on_end(A, b, lane, o.samples[job, k])
        elif SERIES:
            on_series(A, b, lane, o.times[k], o.samples[job, k])
        elif STEPPED:
            on_step(A, b, lane, o.times[k], o.samples[job, k], o)
        else:
            on_quintic(A, b, lane, o.times[k], o.samples[job, k])
        k += 1
    A[b + ROW_SAMPLE * WIDTH + lane] = k
    A[b + ROW_NEXT_SAMPLE * WIDTH + lane] = o.times[k] if k < o.times.shape[0] else np.inf
