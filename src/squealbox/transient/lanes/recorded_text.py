"""The text by which a Runge-Kutta step of a recorded motion without events keeps its works, reversals and contacts."""

from typing import Any

from squealbox.transient.lanes.event_text import EventText

CALMER = 0.1  # of a reversal that a step without one makes up for
KEPT = {"normal": "normal", "speed": "speed", "force": "friction"}  # of each contact at the end of a step, in rows


class RecordedText(EventText):
    """Writes it for `step_text`."""

    def begun(self) -> dict[str, list[str]]:
        """The contacts at the start of the step, as the rows keep them."""
        return {name: [self.row(f"{row}_end{c}") for c in range(self.shape.m)] for name, row in KEPT.items()}

    def record(self, contact: Any, old: Any) -> None:
        """Works done, by the weights of the method as the state itself; reversals; and the contacts at the end."""
        m, begun, end = self.shape.m, self.begun(), contact[-1]
        parts: list[list[str]] = [[] for _ in range(m + 4)]
        for j, weight in enumerate(self.rule.b):
            if weight != 0.0:
                for k, power in enumerate(self.powers_at(j, old, contact[j - 1] if j else begun)):
                    parts[k] += [f"{float(weight)!r} * ({power})"] if power else []
        for k, terms in enumerate(parts):
            done = self.row(f"done{k}")
            self.keep(f"was{k}", done)
            if terms:
                self.keep(f"done{k}", f"where(accepted, {done} + hh * ({' + '.join(terms)}), {done})")
        if m:
            turned = [f"(({x} > 0.0) ^ ({y} > 0.0))" for x, y in zip(begun["speed"], end["speed"], strict=True)]
            self.put(f"turned = accepted & ({' | '.join(turned)})")
            flips = self.row("flips")
            self.keep("reversals", f"{self.row('reversals')} + 1.0 * turned")
            calmer = f"where(accepted, maximum({flips} - {CALMER!r}, 0.0), {flips})"
            self.keep("flips", f"where(turned, {flips} + 1.0, {calmer})")
        for name, row in KEPT.items():
            for c in range(m):
                self.keep(f"{row}_end{c}", f"where(accepted, {end[name][c]}, {self.row(f'{row}_end{c}')})")

    def powers_at(self, stage: int, old: Any, contact: dict[str, list[str]]) -> list[str]:
        """Powers at a stage, the contacts as they are there."""
        n, m = self.shape.n, self.shape.m
        q, v = old if stage == 0 else ([f"{x}{i}s{stage}" for i in range(n)] for x in "qv")
        time = "t_" if stage == 0 else "t_ + hh" if stage == self.rule.stages else f"t_ + {self.rule.c[stage]!r} * hh"
        time = self.within(time)
        load = [self.signal(2 * m + n + i, f"F{i}", time) for i in range(n)]
        opened = [self.openness(c, contact["normal"][c]) for c in range(m)]
        return self.powers((q, v), contact, load, opened)
