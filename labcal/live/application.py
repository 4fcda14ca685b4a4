"""The requests that the live page answers."""

import asyncio
import json
import secrets
import time
from collections.abc import Awaitable, Callable
from dataclasses import asdict
from functools import cache
from importlib import resources
from typing import Any

from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import HTMLResponse, JSONResponse, PlainTextResponse, Response
from starlette.routing import Route

from labcal.live.board import Board
from labcal.live.command import Command, Wish

LONGEST_WAIT_S = 1.0
"""A request for something newer waits so long, then gets what there is."""
_LOOK_S = 0.015


def live_application(board: Board) -> Starlette:
    """Return the application that shows a board; whoever may ask is the guard's matter.

    Its requests:

    - ``GET /``: the page;
    - ``GET /state?after=N``: the state as JSON, once its number is more than N, with ``number``;
    - ``GET /pictures/CAMERA?after=N``: the newest picture as JPEG, once its number is more than N; the header
      ``X-Number`` tells its number;
    - ``GET /rig``: the page of the calibrated rig;
    - ``POST /wishes``: ``{"command": WORD}``, a word of :class:`~labcal.live.command.Command`; of ``drop``
      with ``"view": NAME``.

    Parameters
    ----------
    board : Board
    """

    async def page(_: Request) -> Response:
        nonce = secrets.token_urlsafe(16)
        policy = (
            f"default-src 'none'; script-src 'nonce-{nonce}'; style-src 'nonce-{nonce}'; img-src data:; "
            "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
        )
        return HTMLResponse(_page(nonce), headers={"content-security-policy": policy})

    async def state(request: Request) -> Response:
        board.asked_s = time.monotonic()
        await _newer(request, lambda: board.state_number)
        return JSONResponse({"number": board.state_number, **asdict(board.shown)})

    async def picture(request: Request) -> Response:
        camera = request.path_params["camera"]
        if board.picture(camera) is None:
            known = any(one.name == camera for one in board.shown.cameras)
            return Response(status_code=204) if known else _absent()

        def number() -> int:
            return (board.picture(camera) or (0, b""))[0]

        await _newer(request, number)
        newest = board.picture(camera) or (0, b"")
        return Response(newest[1], media_type="image/jpeg", headers={"x-number": str(newest[0])})

    async def rig(_: Request) -> Response:
        if board.page is None:
            return _absent()
        policy = (
            "default-src 'none'; img-src data: blob:; style-src 'unsafe-inline'; script-src 'unsafe-inline'; "
            "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
        )
        return HTMLResponse(board.page, headers={"content-security-policy": policy})

    async def wishes(request: Request) -> Response:
        try:
            wish = _wish_in(json.loads(await request.body()), board)
        except (ValueError, TypeError, KeyError, RecursionError):
            words = ", ".join(Command)
            text = (
                f'Expected {{"command": WORD}} with one of: {words}; of drop with the "view" of the shoot.\n'
            )
            return PlainTextResponse(text, 400)
        board.wish(wish)
        return JSONResponse(asdict(wish))

    routes = [
        _route("/", page),
        _route("/state", state),
        _route("/pictures/{camera}", picture),
        _route("/rig", rig),
        Route("/wishes", wishes, methods=["POST"]),
    ]
    application = Starlette(routes=routes)
    application.router.redirect_slashes = False
    return application


def _wish_in(given: Any, board: Board) -> Wish:  # noqa: ANN401 -- whatever was sent
    """Return the wish that was sent; ValueError, TypeError or KeyError where it is none."""
    wish = Wish(Command(given["command"]), given.get("view", "") if isinstance(given, dict) else "")
    names = {one.name for one in board.shown.taken}
    if wish.view not in (names if wish.command is Command.DROP else {""}):
        raise ValueError(wish.view)
    return wish


def _route(path: str, answer: Callable[[Request], Awaitable[Response]]) -> Route:
    return Route(path, answer, methods=["GET"])


async def _newer(request: Request, number: Callable[[], int]) -> None:
    """Wait until a number is more than the one that the request has."""
    text = request.query_params.get("after", "0")
    after = int(text) if text.isascii() and text.isdigit() and len(text) <= 12 else 0  # noqa: PLR2004
    end = time.monotonic() + LONGEST_WAIT_S
    while number() <= after and time.monotonic() < end:  # noqa: ASYNC110 -- other threads write to the board
        await asyncio.sleep(_LOOK_S)


def _absent() -> Response:
    return PlainTextResponse("There is no such thing here.\n", 404)


def _page(nonce: str) -> str:
    """Return the page, whose style and script may run for this answer only."""
    page, style, script = _parts()
    return page.replace("@NONCE@", nonce).replace("@STYLE@", style).replace("@SCRIPT@", script)


@cache
def _parts() -> tuple[str, str, str]:
    files = resources.files("labcal.live") / "templates"
    page, style, script = (
        (files / name).read_text(encoding="utf-8") for name in ("live.html", "live.css", "live.js")
    )
    return page, style, script
