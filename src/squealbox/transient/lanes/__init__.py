"""The engine of ensembles: eight trajectories side by side in packed registers, or one alone.

`table` makes jobs of a batch of systems and `shape` says what a kernel is compiled for. `equation_text` writes the
equation of motion with the `formulas` of laws and schedules, `step_text` and `event_text` a Runge-Kutta step along it,
`taylor_text` one along its `series`. `service` and `crossing` look after single lanes, `vectors` and `tracing` turn
plain Python into packed code, and `kernel` joins them. Depends on: the scalar march, friction, schedules, system.
"""
