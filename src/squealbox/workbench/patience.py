"""Connections that are opened and not used: a request that is never finished is ended after some seconds."""

import asyncio

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol

PATIENCE = 15.0  # s without the end of the headers, or without another piece of the body


class Patient(H11Protocol):
    """HTTP as uvicorn speaks it, for which the client is not waited for without end.

    Headers must be complete within `patience` seconds from the connection (or from the answer before), and a body must
    go on within as many. uvicorn itself ends only connections that have been answered.
    """

    patience = PATIENCE
    _since, _watched = 0.0, True

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """The client is here: from now on it is waited for."""
        super().connection_made(transport)
        self._since = self.loop.time()
        self._look()

    def data_received(self, data: bytes) -> None:
        """Another piece: of a body it starts the time anew, of headers only their end does."""
        super().data_received(data)
        if self.conn.their_state is not h11.IDLE:
            self._since = self.loop.time()

    def on_response_complete(self) -> None:
        """An answer is gone: the next request has its own time."""
        self._since = self.loop.time()
        super().on_response_complete()

    def handle_websocket_upgrade(self, event: h11.Request) -> None:
        """A WebSocket has its own protocol, with pings and a time for its handshake."""
        self._watched = False
        super().handle_websocket_upgrade(event)

    def _look(self) -> None:
        if self.transport.is_closing() or not self._watched:
            return
        waiting = self.conn.their_state in (h11.IDLE, h11.SEND_BODY)
        left = self._since + self.patience - self.loop.time() if waiting else self.patience
        if left <= 0.0:
            self.transport.close()
        else:
            self.loop.call_later(left, self._look)
