"""What a move of a slider costs, in counts: questions, answers, bytes, drawings, spectra. Times are for benchmarks."""

import json
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from squealbox import DrumBrake, workbench
from squealbox.workbench.frames import frame, unframed
from squealbox.workbench.panels import Options, Work, function_of
from workbench.browsing import Page

VIEWS = {
    "locus",
    "drawing",
    "verdict",
    "moving",
    "friction",
    "energy",
    "motion",
}  # of the first question, and the words
PAINTS = """() => import('/static/app.js').then(({ app }) => {
    window.paints = [];
    for (const view of app.views) {
        const draw = view.draw;
        view.draw = frame => { window.paints.push(view.name); draw(frame); };
    }
})"""
DRAG = """([path, values]) => new Promise(done => {
    const slider = document.querySelector(`[data-slider="${path}"]`);
    const next = () => {
        if (!values.length) {
            slider.dispatchEvent(new Event('change', { bubbles: true }));
            return done();
        }
        slider.value = values.shift();
        slider.dispatchEvent(new Event('input', { bubbles: true }));
        requestAnimationFrame(next);
    };
    next();
})"""


@pytest.fixture
def counted(browser, server):
    """A page with the questions it sent and the answers it got, from when everything is drawn."""
    with Page(browser, server, motion="no-preference") as page:
        sent, received = [], []
        page.page.on("websocket", lambda socket: (
            socket.on("framesent", lambda data: sent.append(json.loads(data))),
            socket.on("framereceived", lambda data: received.append(data)),
        ))  # fmt: skip
        page.goto()
        page.drawn("moving", "friction", "energy")
        page.page.wait_for_selector("#verdict .heard")  # the motion, out of sight, is asked last
        page.page.evaluate(PAINTS)
        sent.clear()
        received.clear()
        yield page, sent, received


def rested(page):
    """Wait until nothing is asked any more: the motion comes last, and is part of the verdict."""
    page.until("""() => import('/static/app.js').then(({ app }) =>
        app.motion && app.views.every(view => !view.busy))""")
    page.page.wait_for_timeout(300)


def views(sent):
    return Counter(each["view"] for each in sent if "view" in each)


def answers(received):
    headers = [unframed(data)[0] for data in received]
    return Counter(each["view"] for each in headers if each["kind"] == "answer")


def test_one_move_asks_and_draws_each_view_once(counted):
    page, sent, received = counted
    page.slide("k3", 170)
    rested(page)
    asked = views(sent)
    assert set(asked) <= VIEWS
    assert set(asked.values()) == {1}, asked
    assert [each["view"] for each in sent[:2]] == ["locus", "drawing"], "the leading figure is asked first"
    kept = [each for each in sent if "view" not in each]
    assert [each["do"] for each in kept] in ([], ["keep"]), "nothing but questions to views, and the state once"
    for _ in range(100):  # the browser tells of a frame some time after it has drawn it
        if answers(received) == asked:
            break
        page.page.wait_for_timeout(50)
    assert answers(received) == asked
    paints = Counter(page.page.evaluate("window.paints"))
    assert paints == asked
    size = sum(len(json.dumps(each)) for each in sent) + sum(map(len, received))
    assert size < 400_000  # 41 kB map, 200 kB motion with its spectrogram, 3 kB locus


def test_a_drag_asks_as_fast_as_it_is_answered_and_no_faster(counted):
    page, sent, received = counted
    moves = 60  # about a second
    page.page.evaluate(DRAG, ["k3", list(np.linspace(120.0, 260.0, moves))])
    page.until("document.querySelector('[data-path=k3]').value === '260'")
    rested(page)
    asked = views(sent)
    assert 2 <= asked["locus"] <= moves
    for view in VIEWS - {"locus", "drawing"}:
        assert asked[view] <= 0.5 * moves, f"{view} is asked at rest and a few times a second, not at each move"
    for _ in range(100):
        if answers(received)["locus"] == asked["locus"]:
            break
        page.page.wait_for_timeout(50)
    kinds = Counter((header.get("view"), header["kind"]) for header in (unframed(data)[0] for data in received))
    assert kinds["locus", "superseded"] == 0, "a question is asked only when the last has been answered"
    assert kinds["locus", "answer"] == asked["locus"]
    last = [each for each in sent if each.get("view") == "locus"][-1]
    assert last["state"]["values"]["k3"] == pytest.approx(260e6)


def test_back_at_what_is_drawn_nothing_is_asked(counted):
    page, sent, _ = counted
    page.page.select_option("#brake", "drum_brake")
    page.page.locator("#verdict").click()
    page.page.wait_for_timeout(800)
    assert not views(sent)


@pytest.mark.parametrize(
    ("panel", "bytes_", "solved"),
    [
        ("locus", 5_000, 98),  # 97 values, tracked once, and the design itself
        ("verdict", 1_000, 600),  # 201 values for crossings, each refined in some steps
        ("map", 60_000, 0),  # 101 x 101 and its boundary by the compiled kernel, which solves no matrix here
        ("energy", 1_000, 4),
        ("sensitivity", 16_000, 4_500),  # the drawing, and and of each of 14 parameters what it needs
        ("friction", 4_000, 0),
        ("motion", 150_000, 4),
    ],
)
def test_spectra_and_bytes_of_an_answer(monkeypatch, panel, bytes_, solved):
    matrices = []
    for name in ("eig", "eigvals"):
        plain = getattr(np.linalg, name)

        def counting(a, plain=plain):
            matrices.append(int(np.prod(np.shape(a)[:-2], dtype=int)))
            return plain(a)

        monkeypatch.setattr(np.linalg, name, counting)
    answer = function_of(panel)(DrumBrake(), Options({}), Work())
    assert sum(matrices) <= solved
    data, arrays = answer.sent()
    assert len(frame({"id": 1, "data": data}, arrays)) <= bytes_


def test_the_page_is_short():
    """What the page is drawn with stays small enough to be read: scripts and styles together."""
    static = Path(workbench.__file__).parent / "static"
    lines = sum(path.read_text().count("\n") for kind in ("*.js", "*.css") for path in static.rglob(kind))
    assert lines <= 3_500
