"""A finite-element brake on the page: its surface moves, is turned by hand and keys, and stands still where asked."""

import pytest

from workbench.browsing import Page
from workbench.conftest import Server

FILE = 'brake = "disc_brake"\nelement_size = "30 mm"\n\n[modes]\nband = ["1 kHz", "5 kHz"]\n'
KNOWN = "import('/static/app.js').then(({ app }) => Boolean(app.panels.get('moving')?.mesh?.re))"
PICTURE = """() => { const canvas = document.querySelector('canvas.mesh');
    const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    let inked = 0, sum = 0;
    for (let i = 0; i < data.length; i += 4) if (data[i + 3]) { inked++; sum += (i % 977) * data[i]; }
    return [inked / (canvas.width * canvas.height), sum, canvas.width / canvas.clientWidth]; }"""


@pytest.fixture(scope="module")
def disc(tmp_path_factory):
    folder = tmp_path_factory.mktemp("disc")
    (folder / "disc.toml").write_text(FILE)
    running = Server(folder, folder / "disc.toml")
    yield running
    running.stop()


def opened(page):
    page.page.goto(page.server.address)
    page.until(KNOWN)
    page.drawn("moving")
    return page


def test_the_surface_moves_and_is_turned_by_keys_wheel_and_hand(disc, browser):
    with Page(browser, disc, motion="no-preference") as page:
        opened(page)
        share, before, _ = page.page.evaluate(PICTURE)
        assert 0.05 < share < 0.9
        page.page.wait_for_timeout(300)
        assert page.page.evaluate(PICTURE)[1] != before
        page.page.click("section[data-panel=moving] >> text=Pause")
        still = page.page.evaluate(PICTURE)
        page.page.wait_for_timeout(200)
        assert page.page.evaluate(PICTURE) == still
        canvas = page.page.locator("canvas.mesh")
        canvas.focus()
        seen = [still[1]]
        for key in ("ArrowLeft", "ArrowUp", "+", "z"):
            page.page.keyboard.press(key)
            seen.append(page.page.evaluate(PICTURE)[1])
        box = canvas.bounding_box()
        page.page.mouse.move(box["x"] + 50, box["y"] + 50)
        page.page.mouse.wheel(0, -200)
        page.page.wait_for_timeout(100)
        seen.append(page.page.evaluate(PICTURE)[1])
        page.page.mouse.down()
        page.page.mouse.move(box["x"] + 90, box["y"] + 60)
        page.page.mouse.up()
        seen.append(page.page.evaluate(PICTURE)[1])
        assert len(set(seen)) == len(seen)
        assert "kHz" in page.says("moving")
        assert "faces" in page.says("moving")
        assert page.page.evaluate("document.documentElement.scrollHeight <= innerHeight")


def test_another_mode_sends_no_second_mesh_and_less_motion_stands_still(disc, browser):
    with Page(browser, disc) as page:
        sent = []
        page.page.on("websocket", lambda socket: socket.on("framesent", lambda data: sent.append(str(data))))
        opened(page)
        still = page.page.evaluate(PICTURE)
        page.page.wait_for_timeout(300)
        assert page.page.evaluate(PICTURE) == still
        page.option("moving", mode=1)
        page.drawn("moving")
        page.until(f"({PICTURE})()[1] !== {still[1]}")
        assert sum('"view":"mesh"' in each for each in sent) == 1


def test_a_phone_has_it_too(disc, browser):
    with Page(browser, disc, size=(390, 844), scheme="dark") as page:
        opened(page)
        assert page.page.evaluate(PICTURE)[0] > 0.05
        assert page.page.evaluate("document.documentElement.scrollWidth <= innerWidth")


def test_a_finite_element_brake_pasted_into_the_page_is_sent_to_the_command_line(page):
    page.page.click("#open")
    page.page.fill("#opener-text", FILE)
    page.page.click("#opener-go")
    page.page.wait_for_selector("#opener-problems >> text=squealbox lab FILE")
