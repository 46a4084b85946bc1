"""The engine of ensembles: sixteen trajectories side by side in packed registers.

`table` makes jobs of a batch of systems, `shape` says what a kernel is compiled for, `step_text`, `event_text` and
`formulas` write its step, `service` and `crossing` look after single lanes, `vectors` turns plain Python
into packed code, and `kernel` joins them. Depends on: the scalar march, friction, schedules, system.
"""
