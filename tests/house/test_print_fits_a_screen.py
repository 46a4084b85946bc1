"""What a session prints of a result or a design: key numbers on a screen, never thousands of lines of arrays."""

import numpy as np
import pytest

from fe_brakes import pad_brake
from result_examples import EXAMPLES
from squealbox import (
    Contact,
    Coulomb,
    DrumBrake,
    MeshedDrumBrake,
    System,
    complex_modes,
    reduce,
    simulate_ensemble,
    stability_map,
    sweep,
    tracked_modes,
)
from squealbox.designs import DESIGNS
from squealbox.result import Result

LINES, WIDTH = 30, 120  # of a terminal on a laptop


def unfit(thing) -> list[str]:
    """What of its `repr` and `print` is no screenful."""
    found = []
    for how in (repr, str):
        text, lines = how(thing), how(thing).splitlines()
        name = f"{how.__name__} of a {type(thing).__name__}"
        found += [] if 0 < len(lines) <= LINES else [f"{name} has {len(lines)} lines: expected at most {LINES}"]
        wide = max(map(len, lines), default=0)
        found += [] if wide <= WIDTH else [f"{name} is {wide} wide: expected at most {WIDTH}"]
        found += [f"{name} shows raw arrays"] * ("array(" in text)
    return found


@pytest.mark.parametrize("name", list(EXAMPLES))
def test_every_result_prints_on_a_screen(name):
    assert unfit(EXAMPLES[name]()) == []


@pytest.mark.parametrize("name", list(DESIGNS))
def test_every_design_prints_on_a_screen(name):
    brake = DESIGNS[name]()
    assert unfit(brake) == unfit(brake.system()) == []
    assert "complex_modes" in str(brake).splitlines()[-1]  # how to go on
    assert all(word in repr(brake) for word in brake.field_names())


def thousand():
    """Results of a thousand points of one brake, and a brake that stands for them all."""
    brake = DrumBrake().replace({"friction.static": np.linspace(0.1, 0.4, 1000)})
    values = np.linspace(0.1, 0.4, 1000)
    return {
        "the brakes": brake,
        "their systems": brake.system(),
        "modes": complex_modes(brake),
        "ensemble": simulate_ensemble(brake, duration=1e-4),
        "sweep": sweep(DrumBrake(), {"friction.static": values}, complex_modes),
        "map": stability_map(DrumBrake(), {"friction.static": values, "load": np.array([900.0, 1e3])}),
        "tracked": tracked_modes(DrumBrake(), "friction.static", values),
    }


def test_a_thousand_points_print_on_a_screen():
    found = thousand()
    assert {name: unfit(each) for name, each in found.items() if unfit(each)} == {}
    assert "1000 completed" in repr(found["ensemble"])


def test_finite_element_brakes_print_on_a_screen():
    full = MeshedDrumBrake(element_size=0.03)
    few = reduce(full, band=(500.0, 4000.0), varying={"friction.static": (0.1, 0.6)})
    large = pad_brake()
    for each in (full, full.system(), few, few.system(), large, large.contacts, complex_modes(few)):
        assert unfit(each) == []


def test_what_is_no_screenful_is_seen():
    class Long:
        def __repr__(self):
            return "array([1])" + "x" * 120 + "\n" * 40

    said = "of a Long has 40 lines: expected at most 30", "of a Long is 130 wide: expected at most 120"
    assert unfit(Long()) == [
        f"{how} {each}" for how in ("repr", "str") for each in (*said, "of a Long shows raw arrays")
    ]


def test_a_system_of_many_freedoms_prints_its_size():
    row = np.eye(50)[0]
    contacts = [Contact(n=row, d=row, t=row, N0=1.0, V=1.0, law=Coulomb(0.3)) for _ in range(40)]
    text = repr(System(M=np.eye(50), C=np.zeros((50, 50)), K=np.eye(50), load=0.0, contacts=contacts))
    assert "50 x 50 numbers" in text
    assert "40 of Contact" in text
    assert len(text) < 2000


def test_small_arrays_are_printed_in_full():
    assert "0.3" in repr(Coulomb(np.array([0.3, 0.4])))


def test_freedoms_contacts_and_instants_are_coordinates():
    motion = EXAMPLES["Trajectory"]()
    labelled = motion.to_dataset()
    assert list(labelled["dof"].values) == ["x", "y"]
    assert labelled.sizes["contact"] == len(set(labelled["contact"].values))
    at = labelled["q"].sel(dof="y").sel(time=2e-3, method="nearest")
    assert float(at) == motion.q[200, 1]
    with pytest.raises(KeyError):
        labelled["q"].sel(dof="z")


def test_an_axis_of_one_parameter_bears_its_name():
    brake = DrumBrake()
    found = simulate_ensemble(brake, {"friction.static": np.array([0.1, 0.2, 0.3]), "load": np.array([900.0, 1e3])},
                              1e-3, grid=True)  # fmt: skip
    labelled = found.to_dataset()
    assert float(labelled["q"].sel({"friction.static": 0.2, "load": 1e3, "dof": "y"})) == found.q[1, 1, 1]
    together = simulate_ensemble(brake, {"friction.static": np.array([0.1, 0.2]), "load": np.array([900.0, 1e3])}, 1e-3)
    assert "axis_0" in together.to_dataset().dims  # both vary along it, so it bears neither's name


@pytest.mark.parametrize("name", [name for name in EXAMPLES if name not in ("Sweep",)])
def test_every_result_is_a_table(name):
    table = EXAMPLES[name]().to_dataframe()
    assert len(table) > 0
    assert table.shape[1] < 500


def test_a_table_has_a_row_an_instant_and_a_column_a_freedom():
    motion = EXAMPLES["Trajectory"]()
    table = motion.to_dataframe()
    assert len(table) == len(motion.t)
    assert np.array_equal(table["q[y]"].to_numpy(), motion.q[:, 1])


def test_a_result_within_a_result_is_saved(tmp_path):
    region = EXAMPLES["Coexistence"]()
    assert len(region.hopf.x) > 1
    again = Result.load(region.save(tmp_path / "region.nc"))
    assert type(again) is type(region)
    assert type(again.hopf) is type(region.hopf)
    for field in ("x", "y", "lyapunov"):
        assert np.array_equal(getattr(again.hopf, field), getattr(region.hopf, field))
    assert again.hopf.parameters == tuple(region.hopf.parameters)
