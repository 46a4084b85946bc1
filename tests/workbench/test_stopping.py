"""Stop ends what runs, whatever it is, and the page says so; a machine without kernels says what it is doing."""

import os
import threading
import time

import psutil
import pytest

from squealbox import DrumBrake
from squealbox.workbench import session
from squealbox.workbench.apart import Died, Processes
from squealbox.workbench.frames import unframed
from squealbox.workbench.panels import Elsewhere, Options, Stopped, Work, following, function_of
from workbench.browsing import Page
from workbench.conftest import Server

STATE = {"brake": "drum_brake", "laws": {}, "values": {"friction.static": 0.45}}
HOURS = """() => import('/static/app.js').then(({ app }) => {
    const view = app.panels.get('motion').view;
    const request = view.request;
    view.request = () => ({ ...request(), options: { start: 'rest', duration: 100000 } });
    view.update();
})"""
LIMIT = 10_000  # ms from the click on Stop to the word on the page: a second, on a machine ten times slower


def stop(page, panel):
    """Press Stop, and wait until the panel says so."""
    button = page.page.locator(f"section[data-panel={panel}] button.stop")
    button.wait_for(timeout=60_000)
    button.click()
    page.page.wait_for_selector(f"section[data-panel={panel}][data-state=stopped]", timeout=LIMIT)
    assert page.says(panel) == "stopped"


def test_hours_of_motion_are_stopped_within_a_second_and_stay_so(page):
    page.drawn("motion")
    page.page.evaluate(HOURS)
    stop(page, "motion")
    page.ask("locus")
    page.ask("motion")
    assert page.says("motion") == "stopped", "coming back to a stopped panel does not start it again"
    page.enter("friction.static", 0.31)
    page.drawn("locus")


@pytest.mark.parametrize(
    ("panel", "press"), [("branch", "Follow"), ("report", "Make the report"), ("tour", "Judge this reading")]
)
def test_what_runs_apart_is_stopped_within_a_second(page, panel, press):
    page.enter("k4", 111)
    page.ask(panel)
    page.page.click(f"section[data-panel={panel}] >> button:text-is('{press}')")
    stop(page, panel)
    page.enter("k4", 112)
    page.drawn("locus")


def test_a_motion_ends_where_nobody_waits():
    shares = []

    def report(share, text):
        shares.append((share, text))
        if len(shares) == 4:
            work.stop()

    work = Work(report)
    with pytest.raises(Stopped):
        function_of("motion")(DrumBrake(), Options({"duration": 1e5}), work)
    assert len(shares) == 4
    assert {text for _, text in shares} == {"following the motion"}


def question(name="branch", options=None):
    return name, {"id": 1, "state": STATE, "options": options or {}}, {}


def nobody(share, text):
    """Does not listen."""


def computing():
    """The processes that compute answers for this one."""
    living = [each for each in psutil.Process().children() if each.status() != psutil.STATUS_ZOMBIE]
    return [each for each in living if "squealbox.workers" in " ".join(each.cmdline())]


def test_a_process_is_killed_and_the_next_question_gets_another():
    processes, said, wanted = Processes(1), [], threading.Event()

    def report(share, text):
        said.append((share, text))
        wanted.set()

    try:
        found = processes.answer(question(), report, wanted.is_set)
        assert found is None
        assert said, "it was stopped before it had begun"
        assert computing() == []
        header, _ = unframed(processes.answer(question("energy"), nobody, lambda: False))
        assert header["kind"] == "answer"
        first = computing()
        processes.answer(question("energy"), nobody, lambda: False)
        assert computing() == first != [], "one process serves many questions"
    finally:
        processes.close()


def test_a_process_that_dies_is_told():
    processes = Processes(1)

    def murder(share, text):
        for child in computing():
            child.kill()

    try:
        with pytest.raises(Died, match="without an answer"):
            processes.answer(question(), murder, lambda: False)
        assert unframed(processes.answer(question("energy"), nobody, lambda: False))[0]["kind"] == "answer"
    finally:
        processes.close()


def test_a_question_that_waits_for_a_process_can_be_stopped():
    processes = Processes(0)
    begin = time.monotonic()
    assert processes.answer(question(), nobody, lambda: time.monotonic() > begin + 0.05) is None


def test_a_kernel_is_compiled_elsewhere(monkeypatch):
    monkeypatch.setattr(following, "needs_compiling", lambda system: True)
    with pytest.raises(Elsewhere, match="happens once"):
        function_of("motion")(DrumBrake(), Options({}), Work())
    with pytest.raises(Elsewhere):
        session.answered("motion", question()[1], {}, Work())
    assert (
        function_of("motion")(DrumBrake(), Options({"duration": 1e-2}), Work(apart=True)).data["outcome"] == "completed"
    )


def test_a_cold_machine_says_what_it_does_and_the_page_lives(browser, tmp_path):
    os.environ["SQUEALBOX_CACHE"] = str(tmp_path / "empty")
    try:
        server = Server(tmp_path)
    finally:
        del os.environ["SQUEALBOX_CACHE"]
    try:
        with Page(browser, server) as page:
            page.goto()
            page.ask("motion")
            says = page.page.locator("section[data-panel=motion] .says")
            says.filter(has_text="compiling the kernel for this design, which happens once").wait_for(timeout=60_000)
            page.ask("locus")  # the rest of the page goes on
            page.page.select_option("section[data-panel=locus] select", "theta1")
            page.drawn("locus")
            page.drawn("motion")
    finally:
        server.stop()
