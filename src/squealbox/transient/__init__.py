"""What happens in time? Depends on: system, friction, schedules, result; numba only when a kernel is needed."""
