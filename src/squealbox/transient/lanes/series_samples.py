"""Samples of a Taylor step: its own series at the instants asked for; compiled by `kernel`."""

# ruff: noqa: F821  (the places of the rows, DOFS and TERMS are generated)
# mypy: disable-error-code="name-defined,no-untyped-def"

import numpy as np


def write_series(A, b, lane, times, samples):
    """State at the instants that lie in the step just taken."""
    job = int(A[b + ROW_JOB * WIDTH + lane])
    k = int(A[b + ROW_SAMPLE * WIDTH + lane])
    t0 = A[b + ROW_T_OLD * WIDTH + lane]
    unit = A[b + ROW_WINDOW * WIDTH + lane] * UNIT_OF_WINDOW
    while k < times.shape[0] and times[k] <= A[b + ROW_T * WIDTH + lane]:
        x = max(times[k] - t0, 0.0) / unit
        for i in range(DOFS):
            q = 0.0
            v = 0.0
            for order in range(TERMS - 1, -1, -1):
                v = v * x + q
                q = q * x + A[b + (ROW_TERM + i * TERMS + order) * WIDTH + lane]
            samples[job, k, i] = q
            samples[job, k, DOFS + i] = v / unit
        k += 1
    A[b + ROW_SAMPLE * WIDTH + lane] = k
    A[b + ROW_NEXT_SAMPLE * WIDTH + lane] = times[k] if k < times.shape[0] else np.inf
