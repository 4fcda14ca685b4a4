"""The guard before the live page: what it lets through comes from this computer's browser, with the token."""

import asyncio
import secrets
from collections.abc import Awaitable, Callable, Iterable, MutableMapping
from dataclasses import dataclass
from http import HTTPStatus
from typing import Any
from urllib.parse import parse_qs

Scope = MutableMapping[str, Any]
Message = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[Message]]
Send = Callable[[Message], Awaitable[None]]
Application = Callable[[Scope, Receive, Send], Awaitable[None]]

MOST_BODY_BYTES = 1024
MOST_TARGET_BYTES = 1024
"""Longest path with its query."""
MOST_HEADER_BYTES = 8192
BODY_S = 5.0
"""Longest wait for the rest of a body."""
_HEADERS = (
    (b"cache-control", b"no-store"),
    (b"x-content-type-options", b"nosniff"),
    (b"x-frame-options", b"DENY"),
    (b"referrer-policy", b"no-referrer"),
    (b"cross-origin-resource-policy", b"same-origin"),
    (b"cross-origin-opener-policy", b"same-origin"),
)
_POLICY = b"default-src 'none'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'"


@dataclass(frozen=True)
class Refused(Exception):  # noqa: N818 -- the name is what happened
    """A request that is not answered."""

    status: HTTPStatus
    reason: str


class Guard:
    """Answers only requests that this computer's browser makes for the page itself, with the token.

    A request needs the token: in a cookie, which the first request with ``?token=`` in its address sets; in
    the address; or in ``Authorization: Bearer``. Its ``Host`` must be this server, so that no foreign name
    that was made to point to 127.0.0.1 gets through; what sends something must come from this server's own
    page (``Origin``, ``Sec-Fetch-Site``). Bodies, addresses and headers that are too long are refused, bodies
    while they are read.

    Parameters
    ----------
    application : Application
        What answers requests that pass; its first message begins a response.
    token : str
    port : int
        Port of the server on 127.0.0.1.
    """

    def __init__(self, application: Application, token: str, port: int) -> None:
        self._application, self._token = application, token.encode()
        self._hosts = {f"127.0.0.1:{port}".encode(), f"localhost:{port}".encode()}
        self._origins = {b"http://" + host for host in self._hosts}
        self._cookie = f"labcal-{port}"  # cookies of a host are shared by all its ports

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request, or refuse it."""
        if scope["type"] != "http":
            return
        try:
            by_address = self._let_in(scope)
            body = await _body(scope, receive)
        except Refused as refused:
            await _refuse(refused, send)
            return
        cookie = f"{self._cookie}={self._token.decode()}; HttpOnly; SameSite=Strict; Path=/".encode()
        extra = ((b"set-cookie", cookie),) if by_address else ()
        await self._application(scope, _replay(body, receive), _with_headers(send, extra))

    def _let_in(self, scope: Scope) -> bool:
        """Return whether the token came in the address; raise where the request is refused."""
        headers: list[tuple[bytes, bytes]] = list(scope["headers"])
        target = scope.get("raw_path", b"") + b"?" + scope["query_string"]
        if len(target) > MOST_TARGET_BYTES:
            raise Refused(HTTPStatus.REQUEST_URI_TOO_LONG, "the address is too long")
        if sum(len(name) + len(value) for name, value in headers) > MOST_HEADER_BYTES:
            raise Refused(HTTPStatus.REQUEST_HEADER_FIELDS_TOO_LARGE, "the headers are too long")
        hosts = _values(headers, b"host")
        if len(hosts) != 1 or hosts[0].lower() not in self._hosts:
            raise Refused(HTTPStatus.MISDIRECTED_REQUEST, "this is not the host that was asked for")
        by_address = self._has_token(_tokens_of_query(scope["query_string"]))
        given = [*_bearers(headers), *_cookies(headers, self._cookie)]
        if not (by_address or self._has_token(given)):
            raise Refused(
                HTTPStatus.FORBIDDEN,
                "the token is missing or wrong: open the address that labcal wrote, with all its letters",
            )
        if scope["method"] not in {"GET", "POST"}:
            raise Refused(HTTPStatus.METHOD_NOT_ALLOWED, "only GET and POST are answered")
        origins, sites = _values(headers, b"origin"), _values(headers, b"sec-fetch-site")
        own = all(origin in self._origins for origin in origins)
        if not own or any(site not in {b"same-origin", b"none"} for site in sites):
            raise Refused(
                HTTPStatus.FORBIDDEN,
                "another page asks for this: type or paste the address into the browser's own line",
            )
        if scope["method"] == "POST" and sites and not origins:
            raise Refused(HTTPStatus.FORBIDDEN, "the request does not say which page it comes from")
        return by_address

    def _has_token(self, given: Iterable[bytes]) -> bool:
        """Compare in a time that does not depend on what is right in it."""
        return sum(secrets.compare_digest(one, self._token) for one in given) > 0


def _values(headers: list[tuple[bytes, bytes]], name: bytes) -> list[bytes]:
    return [value for key, value in headers if key.lower() == name]


def _tokens_of_query(query: bytes) -> list[bytes]:
    return [one.encode("utf-8", "replace") for one in parse_qs(query.decode("latin-1")).get("token", [])]


def _bearers(headers: list[tuple[bytes, bytes]]) -> list[bytes]:
    return [one[7:] for one in _values(headers, b"authorization") if one[:7].lower() == b"bearer "]


def _cookies(headers: list[tuple[bytes, bytes]], name: str) -> list[bytes]:
    start = name.encode() + b"="
    parts = [part.strip() for value in _values(headers, b"cookie") for part in value.split(b";")]
    return [part[len(start) :] for part in parts if part.startswith(start)]


async def _body(scope: Scope, receive: Receive) -> bytes:
    """Read the body of a request that sends one, as far as it may be long."""
    stated = _values(list(scope["headers"]), b"content-length")
    if any(not one.isdigit() or int(one) > MOST_BODY_BYTES for one in stated):
        raise Refused(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, f"more than {MOST_BODY_BYTES} bytes were sent")
    body = bytearray()
    try:
        async with asyncio.timeout(BODY_S):
            while True:
                message = await receive()
                if message["type"] == "http.disconnect":
                    raise Refused(HTTPStatus.BAD_REQUEST, "the request broke off")
                body += message.get("body", b"")
                if len(body) > MOST_BODY_BYTES:
                    raise Refused(
                        HTTPStatus.REQUEST_ENTITY_TOO_LARGE, f"more than {MOST_BODY_BYTES} bytes were sent"
                    )
                if not message.get("more_body", False):
                    return bytes(body)
    except TimeoutError as error:
        raise Refused(HTTPStatus.REQUEST_TIMEOUT, "the rest of the request did not come") from error


def _replay(body: bytes, receive: Receive) -> Receive:
    """Return a receiver that gives the body that was read, then what follows."""
    waiting = [{"type": "http.request", "body": body, "more_body": False}]

    async def receiving() -> Message:
        return waiting.pop() if waiting else await receive()

    return receiving


def _with_headers(send: Send, extra: tuple[tuple[bytes, bytes], ...]) -> Send:
    """Return a sender that adds the headers of every answer; a policy that is there already stays."""

    async def sending(message: Message) -> None:
        if message["type"] == "http.response.start":
            headers = [*message.get("headers", ()), *_HEADERS, *extra]
            if not _values(headers, b"content-security-policy"):
                headers.append((b"content-security-policy", _POLICY))
            message = {**message, "headers": headers}
        await send(message)

    return sending


async def _refuse(refused: Refused, send: Send) -> None:
    """Answer with the reason, and close the connection: the rest of what was sent is not read."""
    text = f"Refused: {refused.reason}.\n".encode()
    headers = [
        (b"content-type", b"text/plain; charset=utf-8"),
        (b"content-length", str(len(text)).encode()),
        (b"connection", b"close"),
    ]
    sending = _with_headers(send, ())
    await sending({"type": "http.response.start", "status": int(refused.status), "headers": headers})
    await sending({"type": "http.response.body", "body": text})
