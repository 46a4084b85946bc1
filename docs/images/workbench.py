"""Take the pictures of the workbench, light and dark, in headless Chromium: `make picture`."""

import base64
import io
import json
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image
from playwright.sync_api import Browser, sync_playwright

SIZE = {"width": 1280, "height": 800}
SQUEALING = {"brake": "drum_brake", "laws": {}, "values": {"friction.static": 0.45}, "settings": {}}
TELLING = "section[data-panel={}][data-state=drawn]"


def main() -> None:
    """One brake that squeals, as its page shows it when it is opened."""
    command = [str(Path(sys.executable).with_name("squealbox")), "lab", "--no-browser", "--port", "0"]
    command.insert(2, tempfile.mkdtemp(prefix="squealbox-pictures-"))  # a project of its own
    server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        assert server.stdout is not None
        address = re.search(r"http\S+", server.stdout.readline())
        assert address is not None
        with sync_playwright() as playwright:
            shell = shutil.which("chromium-headless-shell") or shutil.which("chromium")
            browser = playwright.chromium.launch(executable_path=shell, args=["--no-sandbox"])
            for scheme, name in (("light", "workbench.png"), ("dark", "workbench_dark.png")):
                taken(browser, address[0] + fragment(), scheme, Path(__file__).with_name(name))
            browser.close()
    finally:
        server.terminate()
        server.wait(20)


def taken(browser: Browser, address: str, scheme: str, path: Path) -> None:
    """The page in a colour scheme, in 256 colours, which a page of few colours hardly misses."""
    page = browser.new_context(viewport=SIZE, color_scheme=scheme, reduced_motion="reduce").new_page()
    page.goto(address)
    for panel in ("locus", "moving", "energy", "friction"):
        page.wait_for_selector(TELLING.format(panel), timeout=120_000)
    page.wait_for_selector("#verdict .heard b", timeout=120_000)
    page.wait_for_timeout(500)
    picture = Image.open(io.BytesIO(page.screenshot())).convert("RGB")
    picture.quantize(256, method=Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE).save(path, optimize=True)
    page.context.close()


def fragment() -> str:
    """The design as a link of the workbench carries it."""
    return "#d=" + base64.urlsafe_b64encode(json.dumps(SQUEALING).encode()).decode().rstrip("=")


if __name__ == "__main__":
    main()
