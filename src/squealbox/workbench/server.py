"""The server: the page and its scripts over HTTP, questions and answers over one WebSocket a page."""

import asyncio
import os
import sys
import threading
from collections.abc import AsyncIterator, Awaitable, Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import asynccontextmanager, suppress
from pathlib import Path, PurePosixPath
from typing import Any

from starlette.applications import Starlette
from starlette.middleware import Middleware
from starlette.middleware.trustedhost import TrustedHostMiddleware
from starlette.requests import ClientDisconnect, Request
from starlette.responses import FileResponse, HTMLResponse, JSONResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.websockets import WebSocket, WebSocketDisconnect

from squealbox.workbench.apart import Processes
from squealbox.workbench.beside import Beside
from squealbox.workbench.folder import FOLDER, Project
from squealbox.workbench.frames import frame
from squealbox.workbench.guard import Headers, SameOrigin, Token
from squealbox.workbench.recorded import Recordings

STATIC = Path(__file__).parent / "static"
KINDS = {".js": "text/javascript", ".css": "text/css", ".svg": "image/svg+xml", ".html": "text/html"}
HOSTS = ["127.0.0.1", "localhost"]
LARGEST_MESSAGE = 2_000_000  # bytes; a longer one closes the connection
LEADING = "locus"  # the figure a page shows first
SWITCH = 5e-4  # s after which a computing thread lets another in: messages pass four threads on their way
PATIENCE = 10.0  # s after which the rest is loaded, page or no page
NO_TOKEN = """<!doctype html><html lang="en"><meta charset="utf-8"><title>squealbox</title>
<h1>This address needs its token</h1>
<p>Open the workbench with the address that <code>squealbox lab</code> printed when it started.</p></html>"""


Answering = Callable[[Request], Awaitable[Response]]


class Workbench:
    """The parts of one running workbench: token, file to start with, project, and the threads that compute."""

    def __init__(self, token: Token, project: Project, file: Any = None) -> None:
        self.token, self.project, self.file = token, project, file
        os.environ[FOLDER] = str(project.folder)
        project.sweep()
        sys.setswitchinterval(SWITCH)
        self.pools = {"quick": ThreadPoolExecutor(2, "quick"), "warming": ThreadPoolExecutor(1, "warming")}
        self.pools["project"] = ThreadPoolExecutor(1, "project")
        self.files = {path.relative_to(STATIC).as_posix(): path.read_bytes() for path in STATIC.rglob("*.*")}
        self.recordings, self.beside = Recordings(), Beside()
        self.processes = Processes()
        self.first = threading.Event()  # a page has its first figure
        self.pages = 0

    def app(self) -> Starlette:
        """The application, to be served on loopback."""
        routes = [
            Route("/", self.page),
            Route("/favicon.ico", _file(STATIC / "favicon.svg", "image/svg+xml")),
            Route("/recording", self._for_its_pages(self.record), methods=["POST"]),
            Route("/beside/{group}/{name}", self._for_its_pages(self.stand), methods=["POST"]),
            Route("/paper/{kind}", self._for_its_pages(self.paper), methods=["POST"]),
            Route("/project/{part}/{name}", self._for_its_pages(self.kept), methods=["GET", "POST"]),
            WebSocketRoute("/ws", self.talk),
            Route("/static/{path:path}", self.static),
        ]
        middleware = [
            Middleware(Headers),
            Middleware(TrustedHostMiddleware, allowed_hosts=HOSTS, www_redirect=False),
            Middleware(SameOrigin),
        ]
        return Starlette(routes=routes, middleware=middleware, lifespan=self._life)

    @asynccontextmanager
    async def _life(self, app: Starlette) -> AsyncIterator[None]:
        warming = asyncio.get_running_loop().run_in_executor(self.pools["warming"], self._warm)
        try:
            yield
        finally:
            warming.cancel()
            self.first.set()
            self.processes.close()
            self.recordings.close()
            self.beside.close()
            for pool in self.pools.values():
                pool.shutdown(wait=False, cancel_futures=True)

    async def page(self, request: Request) -> Response:
        """The page, for those who know the token; it stays known to their browser."""
        if not self.token.known(request.scope):
            return HTMLResponse(NO_TOKEN, status_code=403)
        response = FileResponse(STATIC / "index.html", media_type="text/html")
        if self.token.in_address(request.scope):
            about: dict[str, Any] = {"httponly": True, "samesite": "strict", "path": "/", "max_age": 30 * 86400}
            response.set_cookie(self.token.cookie, self.token.token, **about)
        return response

    async def static(self, request: Request) -> Response:
        """A file of the page, from memory: forty come at once, while other threads load what answers need."""
        name = request.path_params["path"]
        if name not in self.files:
            return Response(status_code=404)
        return Response(self.files[name], media_type=KINDS.get(PurePosixPath(name).suffix))

    def _for_its_pages(self, answer: Answering) -> Answering:
        """The answer for those who know the token; what cannot be taken is one sentence."""

        async def answered(request: Request) -> Response:
            if not self.token.known(request.scope):
                return JSONResponse({"message": "this address needs its token"}, status_code=403)
            try:
                return await answer(request)
            except (ValueError, OSError, ClientDisconnect) as error:
                return JSONResponse({"message": str(error)}, status_code=400)

        return answered

    async def record(self, request: Request) -> Response:
        """Take a recording that was dropped onto the page into the folder of this server, under a name it makes."""
        return JSONResponse({"id": await self.recordings.take(request.query_params.get("name", ""), request.stream())})

    async def stand(self, request: Request) -> Response:
        """Take a file that a design names, for when that is read."""
        await self.beside.take(request.path_params["group"], request.path_params["name"], request.stream())
        return JSONResponse({})

    async def paper(self, request: Request) -> Response:
        """A figure of the page as a file for paper."""
        from squealbox.plots import KINDS, LARGEST, drawn_on_paper

        kind = request.path_params["kind"]
        if kind not in KINDS:
            return Response(status_code=404)
        content = bytearray()
        async for piece in request.stream():
            content += piece
            if len(content) > LARGEST:
                return JSONResponse({"message": f"a figure of more than {LARGEST} bytes"}, status_code=413)
        made = await asyncio.get_running_loop().run_in_executor(
            self.pools["warming"], drawn_on_paper, bytes(content), kind
        )
        return Response(made, media_type=KINDS[kind])

    async def kept(self, request: Request) -> Response:
        """A recording or a result of the project: given to the page, or taken from it."""
        part, name = request.path_params["part"], request.path_params["name"]
        if request.method == "POST":
            return JSONResponse({"name": await self.project.take(part, name, request.stream())})
        path = self.project.file(part, name)
        if path is None:
            return Response(status_code=404)
        return FileResponse(path, media_type="application/octet-stream", headers={"content-disposition": "attachment"})

    async def talk(self, socket: WebSocket) -> None:
        """One page's connection from its start to its end."""
        if not self.token.known(socket.scope):
            await socket.close(1008)  # before it is accepted: the handshake is answered with 403
            return
        await socket.accept()
        from squealbox.workbench.session import Session

        self._slow_pools()
        writing = asyncio.Lock()

        async def send(data: bytes) -> None:
            async with writing:
                try:
                    await socket.send_bytes(data)
                except (WebSocketDisconnect, RuntimeError):  # the page left while its answer was computed
                    session.close()

        session = Session(
            send, self.pools, self.processes, told=self._answered, project=self.project, beside=self.beside
        )
        if self.file is not None:
            session.give(self.file)
        self.pages += 1
        try:
            await send(frame({"kind": "hello", **_hello(self.file)}))
            while True:
                message = await socket.receive()
                if message["type"] == "websocket.disconnect":
                    break
                await session.take(message.get("text") or "")
        finally:
            self.pages -= 1
            session.close()

    def _answered(self, view: str) -> None:
        if view == LEADING:
            self.first.set()

    def _slow_pools(self) -> None:
        """Threads of their own for slow panels and those quick with any brake: none waits for another."""
        from squealbox.workbench.panels import PANELS

        for name, panel in PANELS.items():
            if (panel.slow or panel.single or panel.light) and name not in self.pools:
                self.pools[name] = ThreadPoolExecutor(2, name)

    def _warm(self) -> None:
        """Load what the first questions need, while the browser is still opening; kernels after the first figure."""
        from squealbox.designs import DrumBrake
        from squealbox.workbench.panels import PANELS, OptionError, Options, Work, function_of
        from squealbox.workbench.sheet import sheet

        sheet(DrumBrake())
        order = (LEADING, "verdict", *(name for name in PANELS if not PANELS[name].slow), "map")
        for name in dict.fromkeys(order):
            if name == "map":
                self.first.wait(PATIENCE)
            with suppress(OptionError):  # it has nothing to say of this brake, as the surface of finite elements
                function_of(name)(DrumBrake(), Options({}), Work())


def _file(path: Path, kind: str) -> Any:
    async def answer(request: Request) -> Response:
        return FileResponse(path, media_type=kind)

    return answer


def _hello(file: Any) -> dict[str, Any]:
    from squealbox.designs import DESIGNS
    from squealbox.workbench.panels import PANELS

    return {
        "text": file.text if file is not None else "",
        "name": file.found.path.stem if file is not None else "",
        "brakes": [{"name": name, "title": design.title} for name, design in DESIGNS.items()],
        "panels": [panel.data(name) for name, panel in PANELS.items()],
    }
