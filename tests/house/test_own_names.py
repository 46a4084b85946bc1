"""Parameters of one's own systems have names: in Python, in files, and wherever something is varied by name."""

import numpy as np
import pytest

from squealbox import (
    Contact,
    Coulomb,
    OwnBrake,
    OwnContact,
    ParameterError,
    Part,
    System,
    complex_modes,
    critical_value,
    read_design,
    sensitivity,
    simulate_ensemble,
    stability_map,
    sweep,
    write_design,
)
from squealbox.cli import main
from squealbox.files.beginnings import mechanism_example

MASS, K_PAD = np.diag([1.0, 1.0, 2.0]), 3e6
STIFFNESS = np.array([[3.8e6, 1e6, 0.0], [1e6, 1e6, -0.5e6], [0.0, -0.5e6, 2e6]])
ROW = {"n": [0.0, K_PAD, 0.0], "d": [1.0, 0.0, 0.0]}
OWN = OwnBrake(
    M=MASS, C=10.0 * np.eye(3), K=STIFFNESS, normal_force=500.0,
    contacts=(OwnContact(n=[0.0, 0.0, 0.0], d=[1.0, 0.0, 0.0], name="pad"),),
    parts=(Part("k_pad", K_PAD, K=np.diag([0.0, 1.0, 0.0]), n=[[0.0, 1.0, 0.0]]),),
)  # fmt: skip
WHOLE = System(
    M=MASS, C=10.0 * np.eye(3), K=STIFFNESS + K_PAD * np.diag([0.0, 1.0, 0.0]),
    contacts=[Contact(**ROW, t=[1.0, 0.0, 0.0], N0=500.0, V=1.0, law=Coulomb(0.3), name="pad")],
)  # fmt: skip


def test_the_names_of_a_system_reach_its_contacts():
    changed = WHOLE.replace({"friction.static": 0.5, "sliding_speed": 2.0, "contacts.pad.N0": 7.0})
    assert (changed.contacts[0].law.static, changed.contacts[0].V, changed.contacts[0].N0) == (0.5, 2.0, 7.0)
    assert WHOLE.value_of("contacts.1.V") == 1.0
    assert [name for name, _, _ in WHOLE.leaves()] == ["contacts.pad.law.static"]
    with pytest.raises(ParameterError, match="did you mean 'pad'"):
        WHOLE.replace({"contacts.pat.V": 1.0})
    with pytest.raises(ParameterError, match="did you mean 'friction'"):
        critical_value(WHOLE, "fricton.static", (0.0, 1.0))


def test_a_system_a_brake_of_parts_and_a_function_have_one_onset():
    def made(friction):
        return WHOLE.replace({"friction.static": friction})

    onsets = [critical_value(each, "friction.static", (0.0, 1.0)).value for each in (WHOLE, OWN, made)]
    assert np.ptp(onsets) < 1e-9
    assert 0.3 < onsets[0] < 0.4


def test_a_part_is_varied_by_its_name_alone():
    values = np.array([1e6, 2e6, 5e6])
    batch = complex_modes(OWN.replace(k_pad=values))
    for value, eigenvalues in zip(values, batch.eigenvalues, strict=True):
        alone = WHOLE.replace(
            K=STIFFNESS + value * np.diag([0.0, 1.0, 0.0]), contacts=(WHOLE.contacts[0].replace(n=[0.0, value, 0.0]),)
        )
        np.testing.assert_allclose(eigenvalues, complex_modes(alone).eigenvalues, rtol=1e-10)
    found = stability_map(OWN, {"k_pad": values, "friction.static": [0.1, 0.9]})
    assert found.to_dataset()["k_pad"].attrs["units"] == "N/m"
    assert sweep(OWN, {"k_pad": values}, complex_modes).outcome.ok
    assert "k_pad" in sensitivity(OWN).parameters
    assert simulate_ensemble(OWN, {"k_pad": values}, 1e-3).outcome.ok
    assert OWN.value_of("k_pad") == K_PAD
    with pytest.raises(ParameterError, match="did you mean 'k_pad'"):
        OWN.replace(k_pat=1.0)


@pytest.mark.parametrize(
    ("part", "says"),
    [
        (Part("K", 1.0, K=np.eye(3)), "none that the brake has already"),
        (Part("k", 1.0, K=np.eye(2)), "expected 3 x 3 numbers"),
        (Part("k", 1.0, n=np.eye(3)), "expected 1 x 3 numbers"),
        (Part("k", 1.0), "one or more of M, C, K, n, load"),
    ],
)
def test_a_part_that_fits_nowhere_is_refused(part, says):
    with pytest.raises(ParameterError, match=says):
        OWN.replace(parts=(part,))


def test_parts_are_written_read_and_varied_from_the_command_line(tmp_path, capsys):
    path = write_design(OWN, tmp_path / "own.toml")
    assert read_design(path) == OWN
    text = path.read_text().replace("value = 3000000.0 ", 'value = "3 kN/mm" ')
    assert '"3 kN/mm"' in text
    path.write_text(text)
    assert read_design(path).value_of("k_pad") == K_PAD
    given = ["--set", "friction.static=0.9", "--parameter", "k_pad", "--range", "1 kN/mm", "5 kN/mm"]
    assert main(["onset", str(path), *given]) == 0
    assert "k_pad = 1524148 N/m: squeal begins" in capsys.readouterr().out
    path.write_text(text.replace('"3 kN/mm"', '"3 kg"'))
    assert main(["modes", str(path)]) == 2
    assert "parts[0].value" in capsys.readouterr().err


def test_parts_of_a_mechanism_have_names_and_make_maps():
    mechanism = mechanism_example()
    known = mechanism.scalars()
    assert {"bodies.pad.mass", "springs.1.stiffness", "springs.4.damping", "contacts.1.stiffness"} <= set(known)
    assert known["springs.1.angle"].unit == "rad"
    names = ["bodies.pad.mass", "springs.1.angle", "contacts.1.stiffness"]
    values = np.array([0.5, 1.0, 2.0])
    for name in names:
        batch = complex_modes(mechanism.replace({name: values * mechanism.value_of(name)}))
        for factor, eigenvalues in zip(values, batch.eigenvalues, strict=True):
            alone = complex_modes(mechanism.replace({name: factor * mechanism.value_of(name)}))
            np.testing.assert_allclose(eigenvalues, alone.eigenvalues, rtol=1e-9)


def test_systems_contacts_and_laws_have_a_summary_and_a_card():
    for sheet, word in ((WHOLE, "stiffness"), (WHOLE.contacts[0], "N/m"), (Coulomb(0.3), "kinetic"), (OWN, "k_pad")):
        assert word in sheet.summary()
        assert len(sheet.summary().splitlines()) <= 40
        card = sheet._repr_html_()
        assert type(sheet).__name__ in card
        assert "<script" not in card
    assert "Without friction" in WHOLE._repr_html_()


def test_a_name_with_a_space_addresses_a_contact(tmp_path):
    """It was refused, and `leaves` told a number in its place; the gallery's own contacts are called "shoe 1"."""
    pads = tuple(
        OwnContact(n=[2.0, 0.0], d=[0.0, 1.0], name=f"pad {side}", friction=Coulomb(0.3)) for side in ("left", "right")
    )
    brake = OwnBrake(M=np.eye(2), K=[[2.0, 1.0], [1.0, 2.5]], contacts=pads, sliding_speed=1.0, normal_force=1.0)
    name = "contacts.pad left.friction.static"
    assert name in [each for each, _, _ in brake.leaves()]
    assert brake.replace({name: 0.5}).contacts[0].friction.static == 0.5
    assert brake.replace({name: 0.5}).contacts[1].friction.static == 0.3
    # (K11 - K22)^2 = -4 K12 (K21 - 2 (mu1 + mu2)) where the two modes meet
    onset = float(critical_value(brake, name, (0.0, 2.0)).value)
    assert onset == pytest.approx((1.0 + 0.25 / 4.0) / 2.0 - 0.3, rel=1e-9)
    assert onset == float(critical_value(brake, "contacts.1.friction.static", (0.0, 2.0)).value)
    assert "contacts.pad left: OwnContact" in brake.summary()
    with pytest.raises(ParameterError) as caught:
        brake.value_of("contacts.pad leftt.friction.static")
    assert str(caught.value) == "OwnBrake.contacts.pad leftt: did you mean 'pad left'? one of pad left, pad right"
    assert read_design(write_design(brake, tmp_path / "own.toml")) == brake
    assert main(["modes", str(tmp_path / "own.toml"), "--set", f"{name}=0.1"]) == 0


def test_the_summary_of_a_brake_of_ones_own_shows_its_named_numbers():
    """It stopped at a screenful of contacts, before the parts, and told units of what is left out."""
    pads = tuple(OwnContact(n=[2.0, 0.0], d=[0.0, 1.0], name=f"pad_{i}") for i in range(12))
    parts = (Part("k_pad", 3e6, K=np.eye(2)), Part("c_pad", 3.0, C=np.eye(2)))
    brake = OwnBrake(M=np.eye(2), K=np.eye(2), contacts=pads, parts=parts)
    told = brake.summary()
    assert "parts.k_pad" in told
    assert "parts.c_pad" in told
    assert "None N" not in told
    assert len(told.splitlines()) <= 30
    assert len(repr(brake)) < 400
