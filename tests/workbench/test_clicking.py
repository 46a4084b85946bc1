"""A hand that presses and types at random finds no script error, no dead panel and no page that grows."""

from workbench.browsing import Page
from workbench.clicking import clicked
from workbench.conftest import Server

GROWTH = 0.5  # of the elements of the page between two looks at the same design


def test_what_a_random_hand_does_breaks_nothing(browser, tmp_path):
    server = Server(tmp_path)
    with Page(browser, server, motion="no-preference") as page:  # leaving it fails on script errors
        page.goto()
        found = clicked(page, server, 0.0, seed=7, visits=60)
        assert found["dead"] == []
        first, *_, last = found["looks"]
        assert last["nodes"] < (1.0 + GROWTH) * first["nodes"]
    server.stop()
    assert "Traceback" not in (tmp_path / "server.log").read_text()
