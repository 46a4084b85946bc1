"""`squealbox absorber`: the best tuned mass for a brake."""

from pathlib import Path

from squealbox.cli.answers import show, written
from squealbox.cli.inputs import NOTHING_SAID, Said, folder, keywords, number, read
from squealbox.cli.options import AS_WRITTEN, Asked
from squealbox.cli.running import UsageError
from squealbox.countermeasures import AbsorberSettings, best_absorber
from squealbox.files import write_design
from squealbox.waiting import Progress
from squealbox.writing import write

ABOUT = {"absorber": "the best tuned mass: frequency, damping, how narrow it is"}


def absorber(
    file: Path,
    *,
    on: str,
    mass: str,
    how: Said[AbsorberSettings] = NOTHING_SAID,
    asked: Asked = AS_WRITTEN,
    out: Path | None = None,
) -> None:
    """The best tuned mass: frequency and damping, what it brings, and how narrow it is.

    Parameters
    ----------
    file
        design file; its section [scatter] is needed for --aim probability
    on
        degree of freedom it stands on, such as y
    mass
        of the absorber, with or without a unit: "50 g"
    out
        folder for the detuning map, its numbers and the brake with its absorber as a design file
    """
    found = read(file, asked)
    settings = how.over(AbsorberSettings())
    if settings.aim == "probability" and found.scatter is None:
        raise UsageError(f"{file} has no section [scatter], which --aim probability needs")
    kilograms = number(mass, "kg", f"--mass {mass[:60]}")
    scatter = found.scatter.scatter if found.scatter else None
    folder(out, "absorber", "with_absorber")
    with Progress("tuning the absorber"):
        best = best_absorber(found.design, on, kilograms, scatter=scatter, **keywords(settings))
    show(f"{found.design.title}, {file}", best)
    if out is not None:
        paths = write(best, out, "absorber", title=found.path.name)
        print(written(*paths, write_design(best.design, out / "with_absorber.toml")))
