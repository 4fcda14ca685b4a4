"""A connection to the live page that may not be kept waiting: a request's head has to come at once."""

import asyncio
from typing import Any

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol

HEAD_S = 5.0
"""Longest wait for the first line and the headers of a request, s."""


class PromptConnection(H11Protocol):
    """A connection that is closed where the head of a request does not come in time.

    Without it, connections that send a byte now and then would take all places and shut the page out.
    """

    _late: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Begin to wait for the first request."""
        super().connection_made(transport)  # type: ignore[arg-type]
        self._await_head()

    def data_received(self, data: bytes) -> None:
        """Take bytes in; the first of a request begin the wait for the rest of its head."""
        if self._late is None and self.conn.their_state is h11.IDLE:
            self._await_head()
        super().data_received(data)
        if self.conn.their_state is not h11.IDLE:
            self._have_head()

    def connection_lost(self, exc: Exception | None) -> None:
        """Wait for nothing more."""
        self._have_head()
        super().connection_lost(exc)

    def on_response_complete(self) -> Any:  # noqa: ANN401 -- as the library has it
        """Let the next request begin when it likes: an idle connection is closed by the library."""
        self._have_head()
        return super().on_response_complete()

    def _await_head(self) -> None:
        self._late = self.loop.call_later(HEAD_S, self._close)

    def _have_head(self) -> None:
        if self._late is not None:
            self._late.cancel()
            self._late = None

    def _close(self) -> None:
        self._late = None
        if not self.transport.is_closing():
            self.transport.close()
