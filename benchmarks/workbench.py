"""How fast the workbench answers: the page from its command, a slider to a painted figure, many pages, a long day.

    python benchmarks/workbench.py [page | figures | stops | clients | soak]

Needs the extras `workbench` and `dev` and Debian's chromium. Figures are painted in headless Chromium by software, and
browser and server share the machine's cores: what is measured is what a user of a small laptop would wait.
"""

import asyncio
import json
import os
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import psutil
from playwright.sync_api import sync_playwright
from websockets.asyncio.client import connect

from squealbox.workbench.frames import unframed

BROWSER = shutil.which("chromium-headless-shell") or shutil.which("chromium")
FLAGS = [
    "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync",
]  # fmt: skip
CLIENTS, SECONDS = 20, 10.0
SOAK = 100_000
STATE = {"brake": "drum_brake", "laws": {}, "values": {}}

# Moves a slider as a hand does and waits until all the views named have been painted with the new value.
MOVES = """([views, path, values]) => import('/static/app.js').then(async ({ app }) => {
    const slider = document.querySelector(`[data-slider="${path}"]`);
    const times = [];
    for (const value of values) {
        const missing = new Set(views);
        const painted = new Promise(done => app.addEventListener('painted', function listen({ detail }) {
            const values = JSON.parse(detail.key).state.values;
            const away = Math.abs(values[path] / app.store.field(path).factor - value);
            if (away > 1e-9 || !missing.delete(detail.name) || missing.size) return;
            app.removeEventListener('painted', listen);
            done(detail.at);
        }));
        const begin = performance.now();
        slider.value = value;
        slider.dispatchEvent(new Event('input', { bubbles: true }));
        times.push(await painted - begin);
        slider.dispatchEvent(new Event('change', { bubbles: true }));
        await new Promise(done => setTimeout(done, 60));
    }
    return times;
})"""


def started(folder: Path) -> tuple[subprocess.Popen[str], str, int]:
    """`squealbox lab` with its address and port."""
    command = [str(Path(sys.executable).with_name("squealbox")), "lab", "--no-browser", "--port", "0"]
    environment = {**os.environ, "XDG_STATE_HOME": str(folder), "XDG_DATA_HOME": str(folder)}
    for name in ("OPENBLAS_CORETYPE", "OPENBLAS_L2_SIZE"):
        environment.pop(name, None)
    server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment)
    assert server.stdout is not None
    address = re.search(r"http\S+", server.stdout.readline())
    assert address is not None
    port = re.search(r":(\d+)/", address[0])
    assert port is not None
    return server, address[0], int(port[1])


def shown(name: str, times: list[float], asked: str) -> None:
    """One line: median and 95 % of times in ms."""
    ordered = sorted(times)
    late = ordered[min(len(ordered) - 1, round(0.95 * len(ordered)))]
    print(
        f"{name:<48} median {statistics.median(ordered):6.1f} ms, 95 % {late:6.1f} ms, n = {len(times)}; asked {asked}"
    )


ASK = "panel => import('/static/app.js').then(({ app }) => app.questions.askFor(panel))"
# Pictures of the brake that moves, and the seconds gone.
PICTURES = """() => import('/static/app.js').then(({ app }) =>
    [app.panels.get('moving').pictures, performance.now() / 1e3])"""


def page(folder: Path) -> None:
    """From the command to the first page and to the first figure."""
    first, figure = [], []
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=BROWSER, args=FLAGS)
        for _ in range(3):
            begin = time.perf_counter()
            server, address, _ = started(folder)
            opened = browser.new_context(viewport={"width": 1280, "height": 800}).new_page()
            opened.goto(address, wait_until="load")
            opened.wait_for_selector("#fields .row")
            first.append(1e3 * (time.perf_counter() - begin))
            opened.wait_for_selector("section[data-panel=locus][data-state=drawn]", timeout=60_000)
            figure.append(1e3 * (time.perf_counter() - begin))
            opened.context.close()
            stop(server)
        browser.close()
    shown("command to first page with its fields", first, "1000 ms")
    shown("command to first figure", figure, "-")


def figures(folder: Path) -> None:
    """From a slider's move to a painted figure, once all that a page shows at first has been drawn."""
    server, address, _ = started(folder)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=BROWSER, args=FLAGS)
        opened = browser.new_context(viewport={"width": 1280, "height": 800}).new_page()
        opened.goto(address)
        opened.wait_for_selector("section[data-panel=locus][data-state=drawn]", timeout=120_000)
        for views, path, low, high, count, asked in (
            (["locus"], "k3", 120.0, 260.0, 60, "50 / 80 ms"),
            (["locus", "drawing", "verdict"], "k3", 120.0, 260.0, 60, "50 / 80 ms"),
            (["locus", "drawing", "verdict"], "friction.static", 0.35, 0.5, 60, "50 / 80 ms, unstable"),
            (["map"], "k3", 120.0, 260.0, 20, "100 ms"),
            (["motion"], "friction.static", 0.35, 0.5, 20, "120 ms"),
        ):
            name = views[0]
            opened.evaluate(ASK, name)
            opened.wait_for_selector(f"section[data-panel={name}][data-state=drawn]", timeout=120_000)
            opened.wait_for_timeout(1500)
            digits = 0 if path == "k3" else 3  # what a slider's step leaves
            values = [round(low + (high - low) * ((7 * i) % count) / count, digits) for i in range(count)]
            opened.evaluate(MOVES, [views, path, values[:5]])
            before = opened.evaluate(PICTURES)
            shown(f"slider to {', '.join(views)} painted", opened.evaluate(MOVES, [views, path, values]), asked)
            after = opened.evaluate(PICTURES)
            if name == "locus":
                rate = (after[0] - before[0]) / (after[1] - before[1])
                print(f"    meanwhile the brake moves with {rate:.0f} pictures a second; asked 30")
        browser.close()
    stop(server)


# Presses Stop and waits for the word.
STOPS = """panel => new Promise(done => {
    const section = document.querySelector(`section[data-panel=${panel}]`);
    const begin = performance.now();
    new MutationObserver(() => section.dataset.state === 'stopped' && done(performance.now() - begin))
        .observe(section, { attributes: true });
    section.querySelector('button.stop').click();
})"""
HOURS = """() => import('/static/app.js').then(({ app }) => {
    const view = app.panels.get('motion').view;
    const options = { start: 'rest', duration: 1e5 };
    view.request = () => ({ state: app.store.design, options });
    view.again = () => { options.duration += 1; view.update(); };
})"""


def stops(folder: Path) -> None:
    """From a press of Stop to the word "stopped": a motion of hours, and a walk along limit cycles."""
    server, address, _ = started(folder)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=BROWSER, args=FLAGS)
        opened = browser.new_context(viewport={"width": 1280, "height": 800}).new_page()
        opened.goto(address)
        opened.evaluate(ASK, "motion")
        opened.wait_for_selector("section[data-panel=motion][data-state=drawn]", timeout=120_000)
        opened.evaluate(HOURS)
        begins = {
            "motion": "import('/static/app.js').then(({ app }) => app.panels.get('motion').view.again())",
            "branch": "document.querySelector('section[data-panel=branch] .body button').click()",
        }
        for panel, begin in begins.items():
            opened.evaluate(ASK, panel)
            times = []
            for _ in range(5):
                opened.evaluate(begin)
                opened.wait_for_selector(f"section[data-panel={panel}] button.stop:visible", timeout=60_000)
                opened.wait_for_timeout(700)
                times.append(opened.evaluate(STOPS, panel))
            shown(f"{panel} stopped", times, "1000 ms")
        browser.close()
    stop(server)


async def _client(address: str, number: int, end: float, times: list[float]) -> int:
    """One page's slider: ask, wait, ask again; each answer must be its own."""
    crossed = 0
    async with connect(address, max_size=None) as socket:
        await socket.recv()
        i = 0
        while time.perf_counter() < end:
            value = 0.2 + 0.01 * number + 0.0001 * (i % 50)
            state = {**STATE, "values": {"friction.static": value}}
            begin = time.perf_counter()
            await socket.send(json.dumps({"id": i, "view": "locus", "state": state, "options": {}}))
            header, _ = unframed(await socket.recv())
            times.append(1e3 * (time.perf_counter() - begin))
            crossed += header["id"] != i or abs(header["data"]["value"] - value) > 1e-12
            i += 1
            await asyncio.sleep(0.1)
    return crossed


def clients(folder: Path) -> None:
    """Twenty pages moving sliders at once."""
    server, address, port = started(folder)
    times: list[float] = []
    place = f"ws://127.0.0.1:{port}/ws?{address.partition('?')[2]}"

    async def all_of_them() -> list[int]:
        await asyncio.gather(*(_client(place, n, time.perf_counter() + 3.0, []) for n in range(2)))  # warm
        end = time.perf_counter() + SECONDS
        return await asyncio.gather(*(_client(place, n, end, times) for n in range(CLIENTS)))

    crossed = asyncio.run(all_of_them())
    shown(f"{CLIENTS} pages moving sliders, each answer", times, "500 ms")
    print(f"answers that were not the page's own: {sum(crossed)} of {len(times)}")
    stop(server)


def soak(folder: Path, count: int = SOAK) -> None:
    """Memory of the server over many messages: panels, sheets, wrong values, malformed ones."""
    server, address, port = started(folder)
    process = psutil.Process(server.pid)
    place = f"ws://127.0.0.1:{port}/ws?{address.partition('?')[2]}"

    async def messages(first: int, number: int) -> None:
        async with connect(place, max_size=None) as socket:
            await socket.recv()
            for i in range(first, first + number):
                state = {**STATE, "values": {"friction.static": 0.2 + 1e-6 * i, "m": -1.0 if i % 50 == 0 else 1.0}}
                view = ("verdict" if i % 97 == 0 else "drawing", "friction", "energy", "drawing")[i % 4]
                question = {"id": i, "view": view, "state": state, "options": {}}
                if i % 10 == 0:
                    question = {"id": i, "ask": "sheet", "state": state}
                await socket.send("{" if i % 100 == 1 else json.dumps(question))
                await socket.recv()

    async def warm() -> None:
        """Numba and the first map are loaded, as for any page that is open for a while: 111 MB, and no leak."""
        async with connect(place, max_size=None) as socket:
            await socket.recv()
            for view in ("locus", "map", "verdict", "sensitivity", "motion"):
                await socket.send(json.dumps({"id": 0, "view": view, "state": STATE, "options": {}}))
                while unframed(await socket.recv())[0]["kind"] == "progress":
                    pass

    asyncio.run(warm())
    asyncio.run(messages(0, 3000))
    before, begin = process.memory_info().rss, time.perf_counter()
    for part in range(10):  # ten visits of a page
        asyncio.run(messages(3000 + part * count // 10, count // 10))
    grown, seconds = (process.memory_info().rss - before) / 1e6, time.perf_counter() - begin
    print(f"{count} messages in {seconds:.0f} s: memory of the server grew by {grown:.1f} MB; asked 5 MB")
    stop(server)


def stop(server: "subprocess.Popen[str]") -> None:
    """End a server of our own."""
    server.terminate()
    server.wait(20)
    if server.stdout is not None:
        server.stdout.close()


PARTS = {"page": page, "figures": figures, "stops": stops, "clients": clients, "soak": soak}

if __name__ == "__main__":
    for part in sys.argv[1:] or PARTS:
        with tempfile.TemporaryDirectory() as place:
            PARTS[part](Path(place))
