"""What a lane needs besides its steps: the next job, the place of an event, new modes, samples; compiled by `kernel`.

These are scalar passes over one lane of a group. Modes are decided by the very functions of the scalar march, on a
record filled from the lane, so stick, slip and lift-off mean the same in both.
"""

# mypy: disable-error-code="no-untyped-def"

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
from squealbox.transient.by_kind import WITH_EVENTS
from squealbox.transient.lanes.alone import change_alone
from squealbox.transient.lanes.crossing import locate
from squealbox.transient.lanes.of_a_shape import (
    ALL_ROWS,
    BREAKS,
    CONTACTS,
    DOFS,
    FUNCTIONS,
    GIVEN,
    MEMORY,
    RECORDED,
    SAMPLES,
    SERIES,
    SIMPLE,
    STAGED,
    STEPPED,
    TRIES,
    WIDTH,
    Lane,
    gather,
    set_observers,
    step,
)
from squealbox.transient.lanes.recording import add_up, first_row, log_event, room_left, series_held, write_rows
from squealbox.transient.lanes.samples import load_state, on_end, on_quintic, on_series, on_step
from squealbox.transient.lanes.tracing import take

OVERFLOW = 1e200  # a state that large has a series beyond all numbers
TOO_LARGE = 1e30  # one whose error has an eighth power beyond them
DONE, LOST, OVER, EVENT, LANDED, DUE = 1, 2, 4, 8, 16, 32


def run(A, live, o):
    """Advance all groups until no job of the orders is left, or until o.stop[0] is set; `live` counts the busy lanes of
    each group.
    """
    groups = live.shape[0]
    size = A.shape[0] // groups
    if Lane(A, 0, 0).alive < 0.0:  # fresh arrays
        for g in range(groups):
            for k in range(WIDTH):
                live[g] += refill(Lane(A, g * size, k), o)
        if RECORDED and live[0] > 0:
            first_row(Lane(A, 0, 0), o)
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
                    if RECORDED and SERIES:
                        add_up(Lane(A, 0, 0))
                    if RECORDED and WITH_EVENTS and not series_held(Lane(A, 0, 0), o.p):
                        finish(Lane(A, 0, 0), MISSED, o.out)
                        return True
                    if flags != 0:
                        for k in range(WIDTH):
                            if (flags >> k) & 1 != 0:
                                live[g] -= serve(Lane(A, g * size, k), o)
            if busy == 0:
                return True
        if RECORDED or o.stop[0] != 0:
            return False


def serve(lane, o):
    """Look after a flagged lane; returns 1 where it found no further job."""
    code = int(lane.code)
    if SAMPLES and code & DUE:
        write_samples(lane, o)
    if RECORDED and code & DUE:
        write_rows(lane, o)
    ended = RUNNING
    if code & LOST:
        ended = or_chattering(lane, UNDERFLOW, o) if is_finite(lane) else NOT_FINITE
    elif code & OVER and not code & DONE:
        ended = or_chattering(lane, STEP_LIMIT, o)
    elif WITH_EVENTS and code & LANDED:
        ended = change_modes(lane, int(lane.target), o)
    elif TRIES and code & EVENT:
        which = locate(lane)
        if which >= 0:
            ended = change_modes(lane, which, o)
    elif code & DONE:
        ended = next_piece(lane, o)
    if ended == RUNNING:
        return 0
    finish(lane, ended, o.out)
    return 1 - refill(lane, o)


def or_chattering(lane, ended, o):
    """How a job ended that ran out of steps: as told, or because sliding reverses at most of them."""
    if STAGED:
        o.s.count[FLIPS] = int(np.ceil(lane.flips))
        o.s.count[REVERSALS] = int(lane.reversals)
        o.s.clock[STEP] = lane.h
        if chatters(o.p, o.s):
            return CHATTERING
    return ended


def is_finite(lane):
    """Whether the present state and its derivative are numbers: then the step was too small, not the motion lost."""
    total = 0.0
    for i in range(DOFS):
        total += abs(lane.q[i]) + abs(lane.v[i])
        total += abs(lane.acceleration[i])
    return total < (OVERFLOW if SERIES else TOO_LARGE)


def refill(lane, o):
    """Begin the next job in a lane; returns 0 when there is none. A job whose start has no modes ends at once."""
    while True:
        job = take(o.counter)
        if job >= o.total:
            lane.alive = 0.0
            return 0
        for row in range(GIVEN):
            lane.all[row] = o.table[job, o.varies[row]] if o.varies[row] >= 0 else o.fixed[3 + row]
        for row in range(GIVEN, ALL_ROWS):
            lane.all[row] = 0.0
        begin(lane, job, o)
        ended = start(lane, o.p, o.s)
        if ended == RUNNING:
            lane.alive = 1.0
            return 1
        finish(lane, ended, o.out)


def begin(lane, job, o):
    """Clock, counters, start and the observers' memory; fixed holds the end, the start and the cap, then the rows."""
    lane.job = job
    lane.t = o.fixed[1]
    lane.most = o.fixed[2]
    lane.h = lane.first
    lane.t_end = piece_end(lane, o.fixed[0])
    for k in range(DOFS):
        lane.q[k] = lane.start[k]
        lane.v[k] = lane.start[DOFS + k]
    for c in range(CONTACTS):
        lane.lowest[c] = np.inf
        lane.fastest[c] = 0.0
    set_observers(lane, o.fixed)
    if SAMPLES:
        lane.next_sample = o.times[0]
    if WITH_EVENTS:
        lane.target = -1.0
        lane.window_start = o.fixed[1]


def piece_end(lane, end):
    """The next kink of a schedule, or the end."""
    t = lane.t
    first = end
    for k in range(BREAKS):
        at = lane.breaks[k]
        if t < at < first:
            first = at
    return first


def start(lane, p, s):
    """Modes and accelerations at the start."""
    gather(lane, p, s)
    load_state(lane, p, s)
    t = lane.t
    if WITH_EVENTS and not start_modes(p, t, s.state, s.mode, s):
        return TENSION if pulled(p, s) else INCONSISTENT
    refresh(lane, t, p, s)
    return RUNNING


def next_piece(lane, o):
    """Go on behind a kink of a schedule, where a force that jumps may let a contact go; COMPLETED at the end."""
    t = lane.t
    if t >= o.fixed[0]:
        return COMPLETED
    p, s = o.p, o.s
    lane.t_end = piece_end(lane, o.fixed[0])
    gather(lane, p, s)
    load_state(lane, p, s)
    for c in range(CONTACTS):
        s.fresh[c] = 0
    refresh(lane, t, p, s)
    if WITH_EVENTS:
        fastest = 0.0
        for c in range(CONTACTS):
            fastest = max(fastest, abs(s.speed[c]))
        for c in range(CONTACTS):  # its limit may have jumped, or a belt has just come to rest below it
            slips = s.mode[c] != STICK and s.mode[c] != OPEN
            rests = slips and abs(s.speed[c]) <= event_tolerance(p, c, s.state, s, 0.0) + 1e-12 * fastest
            if rests or (s.mode[c] == STICK and s.phi[c] < 0.0):
                lane.resume = lane.h
                lane.force[c] = s.force[c]
                return change_modes(lane, c, o)
    return RUNNING


def refresh(lane, t, p, s):
    """Velocities, accelerations, modes, event functions and the inverse of the sticking contacts, back into a lane."""
    room = p.mk.shape[0]
    derivative(p, t, s.state, s.mode, s, s.dy)
    for i in range(DOFS):
        if p.light:  # an algebraic row follows the others
            lane.q[i] = s.state[i]
        lane.v[i] = s.state[room + i]
        lane.acceleration[i] = s.dy[room + i]
    if STAGED:
        for c in range(CONTACTS):
            lane.normal_end[c] = s.normal[c]
            lane.speed_end[c] = s.speed[c]
            lane.friction_end[c] = s.force[c]
    if WITH_EVENTS:
        hold_matrix(lane, p, s)
        event_values(p, t, s.state, s.mode, s, s.phi)
        for c in range(CONTACTS):
            lane.opened[c] = 1.0 if s.mode[c] == OPEN else 0.0
            lane.slips[c] = 0.0 if s.mode[c] == OPEN else float(s.mode[c])
            lane.fresh[c] = s.leave[c] if s.fresh[c] else 0.0
            lane.noise[c] = force_noise(p, c, s.state, s) if s.mode[c] == STICK else 0.0
            lane.phi[c] = 0.0 if s.fresh[c] else s.phi[c]
            if FUNCTIONS > CONTACTS:
                lane.phi[CONTACTS + c] = s.phi[p.contacts + c]


def hold_matrix(lane, p, s):
    """Rows H: the inverse of t . M^-1 d over the sticking contacts; where it is singular, `_sharing.share_out`."""
    for c in range(CONTACTS):
        for e in range(CONTACTS):
            lane.hold[c * CONTACTS + e] = 0.0
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
            lane.hold[s.stuck[a] * CONTACTS + s.stuck[e]] = s.right[a]


def change_modes(lane, j, o):
    """An event of function j at the present state: new modes, and the bound on events in a window of time."""
    p, s, t = o.p, o.s, lane.t
    done = False
    if SIMPLE:
        before = lane.slips[j]
        done = change_alone(lane, j)
        if done and lane.slips[j] != before:
            lane.events += 1.0
            if RECORDED:
                log_event(lane, j, lane.slips[j], o)
    if not done:
        gather(lane, p, s)
        load_state(lane, p, s)
        solved = apply_event(p, t, s.state, s.mode, s, j if j < CONTACTS else p.contacts + j - CONTACTS)
        for c in range(CONTACTS):
            if s.mode[c] != s.old[c]:
                lane.events += 1.0
                if RECORDED:
                    log_event(lane, c, s.mode[c], o)
        if not solved:
            return TENSION if pulled(p, s) else INCONSISTENT
        opened = j >= CONTACTS or s.old[j] == OPEN or s.mode[j] == OPEN
        refresh(lane, t, p, s)
        if FUNCTIONS > CONTACTS and opened:  # N = 0 there: round-off of the other sign is no event of its own
            c = j if j < CONTACTS else j - CONTACTS
            at = c if s.mode[c] == OPEN else CONTACTS + c
            lane.phi[at] = max(lane.phi[at], 1e-300)
    lane.h = lane.resume
    lane.target = -1.0
    lane.trust = 0.0
    if not SERIES:
        lane.eased = 0.0
    lane.window_events += 1.0
    if t - lane.window_start > lane.window:
        lane.window_start = t
        lane.window_events = 0.0
    if lane.window_events <= 40.0 * (CONTACTS + 1):
        return RUNNING
    gather(lane, p, s)
    load_state(lane, p, s)
    derivative(p, t, s.state, s.mode, s, s.dy)
    for c in range(CONTACTS):
        s.at_zero[c] = s.mode[c] == STICK or c == j
    return TENSION if pulled(p, s) else ZENO


def finish(lane, ended, out):
    """Write what a job leaves: how it ended, its clock and counts, its state and the observers' memory."""
    job = int(lane.job)
    out[job, 0] = ended
    out[job, 1] = lane.t
    out[job, 2] = lane.taken
    out[job, 3] = lane.tries
    out[job, 4] = lane.events if WITH_EVENTS else 0.0
    for k in range(2 * DOFS):
        out[job, 5 + k] = lane.q[k]
    for k in range(MEMORY):
        out[job, 5 + 2 * DOFS + k] = lane.observed[k]
    for c in range(CONTACTS):
        out[job, 5 + 2 * DOFS + MEMORY + c] = lane.lowest[c]
        out[job, 5 + 2 * DOFS + MEMORY + CONTACTS + c] = lane.fastest[c]


def write_samples(lane, o):
    """State at the instants that lie in the step just taken."""
    job = int(lane.job)
    if STEPPED:
        gather(lane, o.p, o.s)
        load_state(lane, o.p, o.s)
    k = int(lane.sample)
    while k < o.times.shape[0] and o.times[k] <= lane.t:
        if o.times[k] == lane.t:
            on_end(lane, o.samples[job, k])
        elif SERIES:
            on_series(lane, o.times[k], o.samples[job, k])
        elif STEPPED:
            on_step(lane, o.times[k], o.samples[job, k], o)
        else:
            on_quintic(lane, o.times[k], o.samples[job, k])
        k += 1
    lane.sample = k
    lane.next_sample = o.times[k] if k < o.times.shape[0] else np.inf
