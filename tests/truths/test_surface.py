"""The surface of finite-element brakes: what is drawn stands where the mesh is, and moves as the full brake does."""

import pickle
from pathlib import Path

import numpy as np
import pytest

from squealbox import complex_modes
from squealbox.fe import DiscBrake, MeshedDrumBrake, reduce
from squealbox.fe.surface import surface_of, with_surface
from squealbox.files.reading import read_file
from squealbox.files.reduced import for_a_page
from squealbox.workbench.panels import Options, Work, function_of

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.fixture(scope="module")
def small():
    return reduce(DiscBrake(element_size=0.03), (1000.0, 5000.0))


def volumes(surface):
    """By the divergence theorem over the faces of each part: positive where they look outwards."""
    corner = surface.places[surface.faces]
    normal = np.cross(corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1]) / 2.0
    each = np.sum(normal * corner.mean(axis=1), axis=1) / 3.0
    return [float(np.sum(each[surface.parts == part])) for part in range(len(surface.names))]


def test_the_faces_enclose_each_component_and_look_outwards():
    brake = DiscBrake(element_size=0.012)
    disc, pads = brake.disc, brake.pads
    ring = np.pi * (disc.outer_radius**2 - disc.inner_radius**2) * disc.thickness
    pad = 0.5 * pads.angle * (pads.outer_radius**2 - pads.inner_radius**2) * (pads.thickness + 0.005)
    np.testing.assert_allclose(volumes(surface_of(brake)), [ring, pad, pad], rtol=3e-3)  # chords for arcs
    drum = volumes(surface_of(MeshedDrumBrake(element_size=0.012)))
    assert drum[0] == pytest.approx(np.pi * (0.12**2 - 0.11**2) * 0.055, rel=3e-3)


def test_a_coarser_surface_has_fewer_faces_and_about_the_same_outline():
    fine, coarse = (surface_of(DiscBrake(element_size=0.012), most) for most in (5000, 700))
    assert (fine.step, coarse.step) == (1, 2)
    assert len(coarse.faces) <= 700 < len(fine.faces)
    np.testing.assert_allclose(volumes(coarse), volumes(fine), rtol=0.01)


def test_a_node_moves_as_in_the_full_brakes_mode(small):
    drawn = with_surface(small)
    answer = function_of("moving")(drawn, Options({}), Work())
    shown = np.asarray(answer.arrays["re"]) + 1j * np.asarray(answer.arrays["im"])
    assert np.max(np.abs(shown)) == pytest.approx(1.0)
    modes = complex_modes(small)
    at = int(np.argmin(np.abs(modes.frequency - answer.data["modes"][0][0])))
    whole = small.expand(modes.mode(at).shape[: small.system().size])  # of the full brake, by its own basis
    surface, (_, places) = drawn.surface, DiscBrake(element_size=0.03).node_rows()
    free = np.flatnonzero(surface.rows[:, 0] >= 0)
    np.testing.assert_allclose(places[surface.rows[free, 2]], surface.places[free], atol=1e-12)
    expected = whole[surface.rows[free]]
    turn = np.vdot(expected, shown[free]) / np.vdot(expected, expected)  # a mode is known but for a complex factor
    np.testing.assert_allclose(shown[free], turn * expected, atol=1e-5)
    held = surface.rows[:, 0] < 0
    assert np.any(held), "the bore"
    assert np.all(shown[held] == 0.0)


def test_what_goes_to_the_page_leaves_the_full_brake_behind_and_can_be_a_key(small):
    drawn = with_surface(small)
    assert drawn.full is None
    same = drawn.replace({"friction.static": float(drawn.friction.static)})
    assert (hash(drawn), drawn) == (hash(same), same)
    assert drawn.replace({"friction.static": 0.2}) != drawn
    assert pickle.loads(pickle.dumps(drawn)).reduction == drawn.reduction


def test_exported_matrices_are_drawn_by_their_nodes():
    drawn = for_a_page(read_file(EXAMPLES / "caliper" / "caliper.toml"))
    surface = drawn.surface
    assert surface.names == ("disc", "pad")
    assert np.all(surface.faces == np.arange(22)[:, None])
    np.testing.assert_allclose(surface.places[0], [0.1, -0.03, 0.0])
    assert "name no elements" in function_of("moving")(drawn, Options({}), Work()).data["words"]
