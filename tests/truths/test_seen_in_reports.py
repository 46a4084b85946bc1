"""A finite-element brake in its report: what is drawn is the mode, and what is told in groups adds up."""

import base64
import json

import numpy as np
import pytest

from squealbox import Coulomb, DiscBrake, complex_modes, mode_energy, plots, reduce
from squealbox.family import ParameterAxis
from squealbox.fe.surface import surface_of
from squealbox.plots.surfaces import REACH, contact_pressure, from_side, mode_on_surface, outline
from squealbox.report import design_page, examine
from squealbox.report.blocks import Table, Vibrating
from squealbox.report.page import every, render
from squealbox.report.vibrating import MOST_FACES, vibrating
from squealbox.shapes import Surface

BAND = (2500.0, 5000.0)


@pytest.fixture(scope="module")
def meshed():
    brake = DiscBrake(element_size=0.05, friction=Coulomb(0.5), pressure=1.5e6)
    return brake, reduce(brake, BAND, varying={"friction.static": (0.2, 0.6)})


@pytest.fixture(scope="module")
def found(meshed):
    return examine(meshed[1], onset=ParameterAxis("friction.static", 0.2, 0.6))


@pytest.fixture(scope="module")
def page(found):
    return design_page(found)


def cube() -> Surface:
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
    faces = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
    return Surface(corners, faces, np.zeros(6, int), ("cube",), np.arange(24).reshape(8, 3), np.zeros((0, 3)), 1)


def test_each_drawn_node_moves_as_the_full_mode_does(meshed):
    brake, small = meshed
    modes = complex_modes(small)
    solid = vibrating(small, modes)
    full = small.expand(modes.most_unstable.shape)
    numbers, places = brake.node_rows()
    middle = surface_of(brake).middle
    drawn = solid.arrays["re"] + 1j * solid.arrays["im"]
    assert np.max(np.abs(drawn)) == pytest.approx(1.0)
    assert 100 < len(solid.arrays["faces"]) // 4 <= MOST_FACES
    shown, known = [], []
    for place, moved in zip(solid.arrays["places"], drawn, strict=True):
        at = np.flatnonzero(np.linalg.norm(places - middle - place, axis=1) < 1e-9)
        if len(set(numbers[at])) == 1 and len(at) == 3:  # a node of its own, free along x, y and z
            shown.append(moved)
            known.append(full[at])
    assert len(shown) > 50
    factor = np.vdot(known, shown) / np.vdot(known, known)
    np.testing.assert_allclose(shown, factor * np.array(known), atol=1e-6)  # surfaces are kept in single precision
    assert np.all(np.isin(solid.arrays["touching"], np.unique(solid.arrays["faces"])))
    assert len(solid.normal) == len(small.reduction.contact_names)


def test_the_page_holds_the_same_numbers_and_stays_light(page):
    (solid,) = every(Vibrating, page.sections)
    html = render(page)
    (packed,) = [part for part in html.split('<script type="application/json">') if part.startswith('{"data":{"names"')]
    data = json.loads(packed.split("</script>")[0])
    for name, values in solid.arrays.items():
        kind, text = data["arrays"][name]
        read = np.frombuffer(base64.b64decode(text), {"Uint16Array": "<u2", "Float32Array": "<f4"}[kind])
        np.testing.assert_allclose(read, np.ravel(values), rtol=1e-6)
    library = max(len(part) for part in html.split("<script"))
    assert len(html) - library < 1.5e6
    assert "import " not in html.split("class Mesh")[1].split("</script>")[0].split("//")[0]
    assert solid.drawing.content[:4] in (b"\x89PNG", b"<?xm")


def test_the_picture_shows_the_largest_motion(meshed):
    brake, small = meshed
    surface = surface_of(brake)
    moved = surface.moved(small.expand(complex_modes(small).most_unstable.shape))
    figure = mode_on_surface(surface, moved)
    shares = surface.shares(moved)
    for panel, view in zip(figure.axes[:2], ((0.6, 0.85), (0.0, 0.0)), strict=True):
        faces = panel.collections[0]
        bent = 1e3 * from_side(surface.places - surface.middle + REACH * surface.size * moved.real, *view)
        drawn = {tuple(np.round(path.vertices[0], 6)) for path in faces.get_paths()}
        assert drawn <= {tuple(np.round(at, 6)) for at in bent[surface.faces[:, 0], :2]}
        assert set(faces.get_array()) <= set(shares)
        assert 0.3 * len(shares) < len(drawn) < 0.7 * len(shares) or len(faces.get_paths()) < len(shares)
    assert plots.drawn(figure, "png")[:4] == b"\x89PNG"


def test_from_the_side():
    axes = np.eye(3)
    np.testing.assert_allclose(from_side(axes, 0.0, 0.0), axes)  # along the axis: x right, y up, z towards the reader
    np.testing.assert_allclose(from_side(axes, 0.0, 0.5 * np.pi)[2], [0.0, 1.0, 0.0], atol=1e-15)  # the axis upright
    np.testing.assert_allclose(np.linalg.norm(from_side(axes, 0.6, 0.85), axis=1), 1.0)


def test_the_outline_is_where_faces_meet_at_an_angle(meshed):
    assert len(outline(cube())) == 12
    surface = surface_of(meshed[0])
    rim = surface.parts[[np.flatnonzero(np.any(np.isin(surface.faces, pair), axis=1))[0] for pair in outline(surface)]]
    ends = np.hypot(*surface.places[outline(surface)[rim == 0]][..., :2].transpose(2, 0, 1))
    np.testing.assert_allclose(ends[:, 0], ends[:, 1], rtol=1e-9)  # of the disc: its two rims and bores, no seam
    assert {round(float(r), 6) for r in ends[:, 0]} == {0.045, 0.14}


def test_groups_of_contacts_add_up(meshed, found):
    _, small = meshed
    energy = mode_energy(small, complex_modes(small).most_unstable)
    grouped = energy.by_group()
    assert grouped.contacts == ("pad 1 point", "pad 2 point")
    assert grouped.growth_rate == pytest.approx(energy.growth_rate, rel=1e-9)
    assert np.sum(grouped.across) == pytest.approx(np.sum(energy.across))
    assert len(grouped.shares) < 10
    tables = [table for table in every(Table, design_page(found).sections) if table.head[0] == "contacts"]
    ((first, *_), _) = tables[0].rows
    assert first == "pad 1 point"
    assert tables[0].rows[0][1] == str(len(small.reduction.contact_names) // 2)


def test_modes_have_error_bars_and_say_who_moves(meshed, found, page):
    brake, _ = meshed
    (table,) = [table for table in every(Table, page.sections) if table.head[:2] == ("mode", "frequency")]
    order = np.argsort(found.mode_table["damping ratio [-]"], kind="stable")
    assert [row[0] for row in table.rows] == [str(i + 1) for i in order[: len(table.rows)]]
    worst = found.band.most_unstable
    assert table.rows[0][2].detail.startswith("± ")
    assert table.rows[0][6].text == "grows"
    shares = brake.shares(worst.shape)
    for name in ("disc", "linings", "backplates"):
        assert found.mode_table[f"share of {name} [-]"][worst.index] == pytest.approx(shares[name][0], rel=1e-9)
        assert f"{name} {100.0 * shares[name][0]:.0f} %" in table.rows[0][4].text
    assert found.shown.title == brake.title  # the reader's brake, not the reduced one
    names = {row[0] for one in every(Table, page.sections) if one.head[0] == "parameter" for row in one.rows}
    assert {"disc.thickness", "pressure", "friction.static"} <= names


def test_the_pressure_on_the_linings_is_that_of_the_preload(meshed):
    brake, _ = meshed
    preload = brake.preload()
    figure = contact_pressure(preload, ("pad 1", "pad 2"))
    for side, panel in enumerate(figure.axes[:2]):
        mine, up = preload.side == side, preload.lifted
        np.testing.assert_allclose(panel.collections[0].get_array(), 1e-6 * preload.pressure[mine & ~up])
        assert len(panel.lines[0].get_xdata()) == np.sum(mine & up)
        assert "% lifted off" in panel.get_title()
