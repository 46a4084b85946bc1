"""Who may talk to the server: pages it served itself, from this machine, by someone who knows the token."""

import hmac
from collections.abc import Mapping
from http.cookies import CookieError, SimpleCookie
from typing import Any
from urllib.parse import parse_qs

from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

POLICY = "; ".join([
    "default-src 'self'",
    "img-src 'self' blob:",  # a figure on its way to a PNG file is a picture the page made itself
    "object-src 'none'",
    "base-uri 'none'",
    "form-action 'none'",
    "frame-ancestors 'none'",
])  # fmt: skip
HEADERS = {
    "content-security-policy": POLICY,
    "x-content-type-options": "nosniff",
    "referrer-policy": "no-referrer",
    "x-frame-options": "DENY",
    "cross-origin-resource-policy": "same-origin",
    "cross-origin-opener-policy": "same-origin",
    "cache-control": "no-cache",
}


class SameOrigin:
    """Refuse with 403 what another site's page asks, HTTP and WebSocket alike: its Origin is not this server's."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Let through what has no Origin (no page of another site) or this server's own."""
        if scope["type"] in ("http", "websocket") and not _same(_headers(scope)):
            response = PlainTextResponse("This page belongs to another site.", status_code=403)
            await response(scope, receive, send)
            return
        await self.app(scope, receive, send)


class Headers:
    """Every HTTP answer carries the policy: nothing from elsewhere, in no frame, kept by no cache unasked."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Add the headers to the start of an answer."""

        async def with_headers(message: Message) -> None:
            if message["type"] in ("http.response.start", "websocket.http.response.start"):
                message["headers"] = [
                    *message.get("headers", []),
                    *((name.encode(), value.encode()) for name, value in HEADERS.items()),
                ]
            await send(message)

        await self.app(scope, receive, with_headers if scope["type"] in ("http", "websocket") else send)


class Token:
    """The word in the start address; a page that was opened with it keeps it in a cookie of its own port."""

    def __init__(self, token: str, port: int) -> None:
        self.token, self.cookie = token, f"squealbox-{port}"

    def in_address(self, scope: Scope) -> bool:
        """True where the address carries the token."""
        given = parse_qs(scope.get("query_string", b"").decode("latin-1")).get("token", [""])
        return self._is(given[-1])

    def known(self, scope: Scope) -> bool:
        """True where address or cookie carry the token."""
        return self.in_address(scope) or self._is(_cookies(scope).get(self.cookie, ""))

    def _is(self, given: str) -> bool:
        return hmac.compare_digest(given.encode(), self.token.encode())


def _headers(scope: Scope) -> dict[str, str]:
    return {name.decode("latin-1").lower(): value.decode("latin-1") for name, value in scope["headers"]}


def _same(headers: Mapping[str, str]) -> bool:
    origin = headers.get("origin")
    return origin is None or origin == f"http://{headers.get('host', '')}"


def _cookies(scope: Scope) -> dict[str, str]:
    jar: Any = SimpleCookie()
    try:
        jar.load(_headers(scope).get("cookie", ""))
    except CookieError:
        return {}
    return {name: morsel.value for name, morsel in jar.items()}
