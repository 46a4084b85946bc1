"""A running workbench, and a page that fails its test on any error or any request to elsewhere."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from workbench.browsing import Page

COMMAND = Path(sys.executable).with_name("squealbox")


class Server:
    """`squealbox lab` as its user starts it."""

    def __init__(self, folder, *words, port=0, token="token-of-the-tests-0123456789"):
        own = {"XDG_STATE_HOME": str(folder), "XDG_DATA_HOME": str(folder)}
        environment = {**os.environ, **own, "SQUEALBOX_TOKEN": token}
        command = [COMMAND, "lab", *map(str, words), "--no-browser", "--port", str(port)]
        self.log = open(folder / "server.log", "w+")  # noqa: SIM115 - closed by stop
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=self.log, text=True, env=environment)
        line = self.process.stdout.readline()
        found = re.search(r"http://127\.0\.0\.1:(\d+)/\?token=(\S+)", line)
        assert found, line + (folder / "server.log").read_text()
        self.address, self.port, self.token = found[0], int(found[1]), token

    def stop(self):
        """End it and give its port back."""
        self.process.terminate()
        self.process.wait(20)
        self.process.stdout.close()
        self.log.close()


@pytest.fixture(scope="session")
def server(tmp_path_factory):
    running = Server(tmp_path_factory.mktemp("workbench"))
    yield running
    running.stop()


@pytest.fixture(scope="session")
def standing(server, browser):
    with Page(browser, server) as opened:
        opened.goto()
        yield opened


@pytest.fixture
def same_page(standing):
    """One page for many tests: each begins with the usual design and the first question, and may leave no error."""
    before = len(standing.errors)
    standing.again()
    yield standing
    assert standing.errors[before:] == []


@pytest.fixture
def page(server, browser):
    with Page(browser, server) as opened:
        opened.goto()
        yield opened
