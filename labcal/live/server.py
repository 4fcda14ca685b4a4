"""The server of the live page, in a thread of its own."""

import secrets
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from types import ModuleType

from labcal.errors import DeviceError
from labcal.extras import optional_module
from labcal.live.board import Board

HOST = "127.0.0.1"
EXTRA = "page"
MOST_CONNECTIONS = 64
MOST_HEAD_BYTES = 16_384
"""Longest request line with its headers; the guard refuses less, this bounds what is held."""
_START_S = 10.0


@dataclass(frozen=True)
class Served:
    """A page that is being served."""

    address: str
    """Address to open in a browser, with the token."""
    port: int


def require_server() -> ModuleType:
    """Return the library that serves, or say what to install.

    Raises
    ------
    DeviceError
        The extra is not installed.
    """
    optional_module("starlette", EXTRA)
    return optional_module("uvicorn", EXTRA)


@contextmanager
def served(board: Board, port: int = 0) -> Iterator[Served]:
    """Serve a board on 127.0.0.1 for the length of a block.

    Parameters
    ----------
    board : Board
    port : int
        0: any that is free.

    Raises
    ------
    DeviceError
        The port is in use, or the extra is not installed.
    """
    uvicorn = require_server()
    from labcal.live.application import live_application  # noqa: PLC0415 -- needs the extra
    from labcal.live.connection import PromptConnection  # noqa: PLC0415
    from labcal.live.guard import Guard  # noqa: PLC0415

    listening = _listening(port)
    port = int(listening.getsockname()[1])
    token = secrets.token_urlsafe(24)
    server = uvicorn.Server(
        uvicorn.Config(
            Guard(live_application(board), token, port),
            http=PromptConnection,
            ws="none",
            lifespan="off",
            log_config=None,
            access_log=False,
            server_header=False,
            date_header=False,
            proxy_headers=False,
            limit_concurrency=MOST_CONNECTIONS,
            h11_max_incomplete_event_size=MOST_HEAD_BYTES,
            timeout_keep_alive=30,
            timeout_graceful_shutdown=2,
        )
    )
    thread = threading.Thread(target=server.run, args=([listening],), name="live-page", daemon=True)
    thread.start()
    try:
        _wait_for(server, thread)
        yield Served(f"http://{HOST}:{port}/?token={token}", port)
    finally:
        server.should_exit = True
        thread.join(5.0)
        listening.close()


def _listening(port: int) -> socket.socket:
    """Return a socket that is bound to this computer alone."""
    made = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    made.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        made.bind((HOST, port))
    except OSError as error:
        made.close()
        raise DeviceError(
            f"The port {port} of {HOST} cannot be used: {error.strerror}. Give another one, or none."
        ) from error
    return made


def _wait_for(server: object, thread: threading.Thread) -> None:
    """Return when the server answers."""
    end = time.monotonic() + _START_S
    while not getattr(server, "started", False):
        if not thread.is_alive() or time.monotonic() > end:
            raise DeviceError("The server of the live page does not start.")
        time.sleep(0.01)
