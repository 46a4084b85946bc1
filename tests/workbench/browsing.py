"""What a test wants to know of a page of the workbench: what is drawn, and what went wrong."""

import time

LINES = """figure => [...figure.querySelectorAll('g.layer')].map(layer => ({
    cls: layer.getAttribute('class'), d: layer.querySelector('path')?.getAttribute('d') ?? '',
    circles: layer.querySelectorAll('circle').length,
}))"""
AGAIN = """() => import('/static/app.js').then(({ app }) => {
    const { store } = app;
    store.settings = {};
    store.replace({ base: null, brake: 'drum_brake', laws: {}, values: {} });
    store.past.length = store.future.length = 0;
    store.dispatchEvent(new Event('history'));
})"""
BEGUN = """() => document.querySelector('[data-path="friction.static"]')?.value === '0.3'
    && document.querySelector('[data-path=theta2]').value === '115'
    && document.querySelector('#panels').dataset.question === 'why'"""
ASK = "panel => import('/static/app.js').then(({ app }) => app.questions.askFor(panel))"
OPTION = "([panel, changes]) => import('/static/app.js').then(({ app }) => app.store.option(panel, changes))"
SPEC = """([name, figure]) => import('/static/app.js').then(({ app }) => {
    const { spec } = app.panels.get(name).charts.find(chart => chart.name === figure);
    const numbers = ({ kind, cls, column = '', x, y }) => ({ kind, cls, column, x: Array.from(x), y: Array.from(y) });
    const layers = spec.layers.filter(({ kind }) => kind === 'line' || kind === 'points');
    return { x: spec.x, y: spec.y, layers: layers.map(numbers) };
})"""


class Page:
    """A page of the workbench. Leaving it fails on script errors and on requests to anything but the server itself.

    It keeps still unless `motion` is "no-preference": a moving brake takes half a core from whatever a test waits for.
    """

    def __init__(self, browser, server, *, scheme="light", size=(1280, 800), motion="reduce"):
        self.server = server
        view = {"width": size[0], "height": size[1]}
        self.context = browser.new_context(viewport=view, color_scheme=scheme, reduced_motion=motion)
        self.page = self.context.new_page()
        self.page.set_default_timeout(300_000)  # a machine ten times slower, with much else to do
        self.errors: list[str] = []
        self.expected: tuple[str, ...] = ()  # parts of messages a test provokes
        own = (f"http://127.0.0.1:{server.port}/", f"ws://127.0.0.1:{server.port}/", "blob:", "data:")
        self.page.on("pageerror", lambda error: self.errors.append(f"script: {error.stack or error}"))
        self.page.on("console", lambda m: self.errors.append(f"console: {m.text}") if m.type == "error" else None)
        self.page.on("request", lambda r: None if r.url.startswith(own) else self.errors.append(f"foreign: {r.url}"))
        self.page.on("websocket", lambda w: None if w.url.startswith(own) else self.errors.append(f"foreign: {w.url}"))

    def __enter__(self):
        return self

    def __exit__(self, kind, *rest):
        self.context.close()
        unexpected = [each for each in self.errors if not any(part in each for part in self.expected)]
        assert kind is not None or not unexpected, unexpected

    def until(self, expression, arg=None, timeout=120.0):
        """Wait until an expression is true; Playwright's own wait evaluates text in the page, which forbids that."""
        end = time.monotonic() + timeout
        while not self.page.evaluate(expression, arg):
            assert time.monotonic() < end, f"not within {timeout:g} s: {expression}"
            self.page.wait_for_timeout(50)

    def again(self):
        """Back to the usual design, no option chosen and nothing to undo."""
        self.page.evaluate(AGAIN)
        self.until(BEGUN)
        self.drawn("locus")

    def goto(self, fragment=""):
        """Open the start address and wait until the first figure is there."""
        self.page.goto(self.server.address + fragment)
        self.drawn("locus")

    def drawn(self, *panels):
        """Wait until these panels show the present design."""
        for panel in panels:
            self.ask(panel)
            self.page.wait_for_selector(f"section[data-panel={panel}][data-state=drawn]", timeout=300_000)

    def ask(self, panel):
        """Ask the question on whose screen a panel stands."""
        self.page.evaluate(ASK, panel)
        self.page.locator(f"section[data-panel={panel}]").scroll_into_view_if_needed()

    def settled(self, panel):
        """Wait until a panel has answered the newest question, with a figure or a sentence."""
        self.ask(panel)
        self.page.wait_for_selector(f"section[data-panel={panel}]:not([data-state=waiting])", timeout=300_000)

    def says(self, panel):
        """The sentence below a panel."""
        return self.page.locator(f"section[data-panel={panel}] .says").inner_text()

    def enter(self, path, value):
        """Type a value into the field of a parameter."""
        field = self.page.locator(f"input[data-path='{path}']")
        field.fill(str(value))
        field.press("Enter")

    def option(self, panel, **changes):
        """Set options of a panel, as its own controls do."""
        self.page.evaluate(OPTION, [panel, changes])

    def slide(self, path, value):
        """Move the slider of a parameter, as dragging it does, and let go."""
        self.page.evaluate(
            """([path, value]) => { const slider = document.querySelector(`[data-slider="${path}"]`);
            slider.value = value; slider.dispatchEvent(new Event('input', { bubbles: true }));
            slider.dispatchEvent(new Event('change', { bubbles: true })); }""",
            [path, value],
        )

    def numbers(self, panel, figure):
        """The numbers a figure was drawn from: axes, and lines and points with their columns."""
        return self.page.evaluate(SPEC, [panel, figure])

    def strokes(self, panel, figure):
        """What stands in the page: class, path and circles of each layer of a figure."""
        return self.page.locator(f"section[data-panel={panel}] figure[data-figure={figure}]").evaluate(LINES)
