"""Many pages and many messages: each gets its own answers, and the server does not grow."""

import asyncio
import json
from concurrent.futures import ThreadPoolExecutor

import psutil
from websockets.asyncio.client import connect

from squealbox.plots.figure_data import unpacked
from squealbox.workbench.frames import unframed
from workbench.conftest import Server

PAGES, MOVES = 20, 5
MESSAGES = 600
STATE = {"brake": "drum_brake", "laws": {}, "values": {}}


def run(coroutine):
    """Run it in a thread of its own: the browser's driver keeps a loop in this one."""
    with ThreadPoolExecutor(1) as thread:
        return thread.submit(asyncio.run, coroutine).result()


def address(server):
    return f"ws://127.0.0.1:{server.port}/ws?token={server.token}"


def curves(header, arrays):
    """The modes drawn, each with 97 points."""
    layers = unpacked(header["data"], arrays, "frequency")["layers"]
    return [layer for layer in layers if layer["kind"] == "line" and len(layer["x"]) == 97]


async def slide(server, number):
    """The values that came back beside those asked for."""
    pairs = []
    async with connect(address(server), max_size=None) as socket:
        await socket.recv()
        for i in range(MOVES):
            asked = 0.2 + 0.01 * number + 0.0001 * i
            state = {**STATE, "values": {"friction.static": asked}}
            await socket.send(json.dumps({"id": i, "view": "locus", "state": state, "options": {}}))
            header, arrays = unframed(await socket.recv())
            pairs.append((header["id"] == i, header["data"]["value"] == asked, len(curves(header, arrays)) == 2))
    return pairs


def test_twenty_pages_move_their_sliders_at_once(server):
    async def everybody():
        return await asyncio.gather(*(slide(server, n) for n in range(PAGES)))

    answers = run(everybody())
    assert [len(each) for each in answers] == [MOVES] * PAGES
    assert all(all(pair) for each in answers for pair in each)


def test_memory_does_not_grow_with_messages(tmp_path):
    """The limit is 1 kB a message; `benchmarks/workbench.py soak` runs 1e5, to see a leak of 200 bytes in each."""
    server = Server(tmp_path)
    process = psutil.Process(server.process.pid)

    async def kernels():
        """Every panel's code is loaded, as for any page that is open for a while."""
        async with connect(address(server), max_size=None) as socket:
            await socket.recv()
            for view in ("locus", "map", "verdict", "sensitivity"):
                await socket.send(json.dumps({"id": 0, "view": view, "state": STATE, "options": {}}))
                while unframed(await socket.recv())[0]["kind"] != "answer":
                    pass

    async def messages(count):
        async with connect(address(server), max_size=None) as socket:
            await socket.recv()
            for i in range(count):
                state = {**STATE, "values": {"friction.static": 0.2 + 1e-5 * i, "m": -1.0 if i % 50 == 0 else 1.0}}
                question = {"id": i, "view": ("drawing", "friction", "energy")[i % 3], "state": state, "options": {}}
                await socket.send("{" if i % 100 == 1 else json.dumps(question))
                await socket.recv()

    try:
        run(kernels())
        run(messages(300))
        before = process.memory_info().rss
        for _ in range(2):
            run(messages(MESSAGES // 2))
        assert process.memory_info().rss - before < 1e3 * MESSAGES
    finally:
        server.stop()
