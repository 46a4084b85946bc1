"""A hand that presses and types at random: what breaks, which panel stays dead, how server and tab grow.

    cd tests && python -m workbench.clicking [minutes] [seed]        an hour unless told otherwise

After every hundred actions it goes back to the usual design and looks whether each panel still answers.
"""

import random
import sys
import tempfile
import time
from pathlib import Path

import psutil

from browsers import launched
from workbench.browsing import AGAIN, BEGUN, Page
from workbench.conftest import Server

LIVING = ("locus", "moving", "energy", "friction", "map", "motion", "sensitivity", "compare")
TYPED = ("0", "-1", "1e400", "1e308", "1e-300", "abc", "1,000", "NaN", "", "0.3", "1", "100", "1 kN", "1e12")
VISITS = 100  # actions between two looks
PATIENCE = 120.0  # s for a panel to answer at such a look
SERVERS, TABS = 50e6, 50e6  # bytes by which server and tab may grow

# One action inside the page: what is on the screen is chosen from, with numbers between 0 and 1 from outside.
ACT = """([kind, one, two, texts]) => {
    const seen = [...document.querySelectorAll(kind)].filter(e => e.getClientRects().length && !e.disabled);
    const it = seen[Math.floor(one * seen.length)];
    if (!it) return '';
    const tell = type => it.dispatchEvent(new Event(type, { bubbles: true }));
    if (it.type === 'range') {
        for (const share of [0.3, 0.7, 1]) {
            it.value = Number(it.min) + share * two * (it.max - it.min);
            tell('input');
        }
        tell('change');
    } else if (it.tagName === 'SELECT') {
        it.selectedIndex = Math.floor(two * it.options.length);
        tell('change');
    } else if (it.type === 'text') {
        it.value = texts[Math.floor(two * texts.length)];
        tell('change');
    } else if (it.tagName === 'svg') {
        const box = it.getBoundingClientRect();
        const place = { clientX: box.x + one * box.width, clientY: box.y + two * box.height };
        const about = { bubbles: true, pointerId: 1, button: 0, ...place };
        it.setPointerCapture = () => {};
        for (const type of ['pointerdown', 'pointermove', 'pointerup']) it.dispatchEvent(new PointerEvent(type, about));
        it.dispatchEvent(new MouseEvent('mousemove', about));
    } else it.click();
    return `${kind} ${it.dataset.path ?? it.dataset.slider ?? it.textContent.slice(0, 30)} ${it.value ?? ''}`;
}"""
KINDS = {
    "input[type=range]": 8, "input[type=text]": 4, "select": 4, "button:not([title^='Save']):not(#link)": 5,
    "button[title^='Save']": 0.1, ".questions button": 4, ".panel svg": 3,
}  # fmt: skip
KEYS = ("Control+z", "Control+Shift+z", "b", "Tab", "ArrowRight", "ArrowDown", "Escape", "Enter")
STATES = "() => [...document.querySelectorAll('.panel')].map(e => [e.dataset.panel, e.dataset.state])"


def acted(page: Page, chance: random.Random) -> str:
    """One action at random, in words."""
    if chance.random() < 0.1:
        key = chance.choice(KEYS)
        page.page.keyboard.press(key)
        return f"key {key}"
    kind = chance.choices(list(KINDS), list(KINDS.values()))[0]
    return page.page.evaluate(ACT, [kind, chance.random(), chance.random(), TYPED])


def dead(page: Page) -> list[str]:
    """Panels that do not answer any more at the usual design, with the state they are stuck in."""
    page.page.evaluate("() => document.querySelectorAll('dialog[open]').forEach(dialog => dialog.close())")
    page.page.evaluate(AGAIN)
    page.until(BEGUN, timeout=PATIENCE)
    found = []
    for panel in LIVING:
        end = time.monotonic() + PATIENCE
        page.ask(panel)
        while (state := dict(page.page.evaluate(STATES))[panel]) != "drawn" and time.monotonic() < end:
            page.page.wait_for_timeout(100)
        if state != "drawn":
            found.append(f"{panel} is {state}")
    return found


def sizes(page: Page, server: Server) -> dict[str, float]:
    """Memory of the server and of the tab [bytes], what JavaScript holds after a clean-up, and elements of the page."""
    session = page.context.new_cdp_session(page.page)
    session.send("Performance.enable")
    session.send("HeapProfiler.collectGarbage")
    told = {each["name"]: each["value"] for each in session.send("Performance.getMetrics")["metrics"]}
    session.detach()
    tab = [
        each.info["memory_info"].rss
        for each in psutil.process_iter(["cmdline", "memory_info"])
        if "--type=renderer" in (each.info["cmdline"] or []) and each.info["memory_info"]
    ]
    own = psutil.Process(server.process.pid).memory_info().rss
    return {"server": own, "tab": max(tab), "heap": told["JSHeapUsedSize"], "nodes": told["Nodes"]}


def clicked(page: Page, server: Server, seconds: float, seed: int, visits: int = VISITS) -> dict[str, object]:
    """Act at random for so long; errors, panels that stayed dead, and sizes at the second look and at the end."""
    chance, end, actions = random.Random(seed), time.monotonic() + seconds, 0
    looks, stuck, done = [], [], []
    while time.monotonic() < end or len(looks) < 3:
        for _ in range(visits):
            done.append(acted(page, chance))
            page.page.wait_for_timeout(chance.choice((0, 20, 200)))
        actions += visits
        stuck += [f"after {actions}: {each}" for each in dead(page)]
        looks.append(sizes(page, server))
    return {"actions": actions, "dead": stuck, "looks": looks, "last": done[-visits:]}


def main(minutes: float, seed: int) -> None:
    """Click for so many minutes and say what came of it."""
    with tempfile.TemporaryDirectory() as folder, launched() as browser:
        server = Server(Path(folder))
        page = Page(browser, server, motion="no-preference")
        page.goto()
        found = clicked(page, server, 60.0 * minutes, seed)
        first, last = found["looks"][min(2, len(found["looks"]) - 1)], found["looks"][-1]
        print(f"{found['actions']} actions in {minutes:g} min, seed {seed}")
        for name, most in (("server", SERVERS), ("tab", TABS)):
            print(f"{name}: {first[name] / 1e6:.1f} -> {last[name] / 1e6:.1f} MB, asked {most / 1e6:.0f} more")
        heap, nodes = [each["heap"] / 1e6 for each in (first, last)], [each["nodes"] for each in (first, last)]
        print(f"heap: {heap[0]:.1f} -> {heap[1]:.1f} MB; {nodes[0]:.0f} -> {nodes[1]:.0f} nodes")
        print(f"dead panels: {found['dead'] or 'none'}")
        print(f"script errors: {len(page.errors)}", *sorted(set(page.errors))[:20], sep="\n  ")
        page.context.close()
        server.stop()
        print("server:", (Path(folder) / "server.log").read_text()[-3000:] or "said nothing")


if __name__ == "__main__":
    given = [float(word) for word in sys.argv[1:]]
    main(given[0] if given else 60.0, int(given[1]) if len(given) > 1 else 0)
