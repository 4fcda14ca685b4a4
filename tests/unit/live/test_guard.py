"""Refusals of the live page: strangers, other pages, other host names, and requests that are too large."""

import contextlib
import json
import socket
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import httpx
import pytest

from labcal.errors import DeviceError
from labcal.live import connection
from labcal.live.board import Board
from labcal.live.command import Command, Wish
from labcal.live.guard import MOST_BODY_BYTES, MOST_HEADER_BYTES, MOST_TARGET_BYTES
from labcal.live.server import MOST_CONNECTIONS, served
from labcal.live.shown import CameraShown, Phase, ViewShown

JPEG = b"\xff\xd8 a picture"
PATHS = ("/", "/state", "/pictures/left", "/rig")


@dataclass
class Bench:
    board: Board
    port: int
    token: str
    client: httpx.Client

    @property
    def own(self) -> str:
        return f"http://127.0.0.1:{self.port}"


@pytest.fixture(scope="module")
def bench() -> Iterator[Bench]:
    board = Board()
    board.show(phase=Phase.AIM, cameras=(CameraShown("left", (640, 480)), CameraShown("right", (640, 480))))
    board.put_picture("left", JPEG)
    board.put_page(b"<!doctype html><title>rig</title>")
    with served(board) as page:
        base, token = page.address.split("/?token=")
        with httpx.Client(base_url=base, timeout=10) as client:
            yield Bench(board, page.port, token, client)


def bearer(bench: Bench) -> dict[str, str]:
    return {"Authorization": f"Bearer {bench.token}"}


def raw(bench: Bench, sent: bytes) -> bytes:
    """Return the first line of the answer to bytes, and close."""
    with socket.create_connection(("127.0.0.1", bench.port), timeout=10) as connection:
        connection.sendall(sent)
        answer = b""
        while b"\r\n" not in answer:
            more = connection.recv(4096)
            if not more:
                break
            answer += more
    return answer.partition(b"\r\n")[0]


def request(bench: Bench, target: str, *lines: str, method: str = "GET") -> bytes:
    head = [f"{method} {target} HTTP/1.1", f"Host: 127.0.0.1:{bench.port}", *lines]
    return ("\r\n".join(head) + "\r\n\r\n").encode()


@pytest.mark.parametrize("path", PATHS)
def test_with_the_token_a_request_is_answered(bench: Bench, path: str) -> None:
    answer = bench.client.get(path, headers=bearer(bench))
    assert answer.status_code == 200
    assert answer.headers["cache-control"] == "no-store"
    assert answer.headers["x-content-type-options"] == "nosniff"
    assert "frame-ancestors 'none'" in answer.headers["content-security-policy"]
    assert "set-cookie" not in answer.headers
    assert "server" not in answer.headers


@pytest.mark.parametrize("path", [*PATHS, "/nothing", "/../etc/passwd"])
@pytest.mark.parametrize("given", [None, "x", "token", "wrong"])
def test_without_the_token_nothing_is_answered(bench: Bench, path: str, given: str | None) -> None:
    wrong = bench.token[:-1] + ("a" if bench.token[-1] != "a" else "b") if given == "wrong" else given
    headers = {} if wrong is None else {"Authorization": f"Bearer {wrong}"}
    cookies = {} if wrong is None else {f"labcal-{bench.port}": wrong}
    for answer in (
        bench.client.get(path, headers=headers),
        httpx.get(f"{bench.own}{path}", cookies=cookies),
        bench.client.get(path, params=None if wrong is None else {"token": wrong}),
        bench.client.post(path, json={"command": "take"}, headers=headers),
    ):
        assert answer.status_code == 403
        assert bench.token not in answer.text
        assert "set-cookie" not in answer.headers
    assert bench.board.next_wish(0.0) is None


def test_the_address_sets_a_cookie_that_scripts_and_other_pages_cannot_use(bench: Bench) -> None:
    with httpx.Client(base_url=bench.own) as client:
        first = client.get("/", params={"token": bench.token})
        cookie = first.headers["set-cookie"]
        assert "HttpOnly" in cookie
        assert "SameSite=Strict" in cookie
        assert client.get("/state").status_code == 200


def test_tokens_differ() -> None:
    addresses = set()
    for _ in range(3):
        with served(Board()) as page:
            addresses.add(page.address.partition("token=")[2])
    assert len(addresses) == 3
    assert min(map(len, addresses)) >= 32


@pytest.mark.parametrize(
    "host", ["evil.example", "evil.example:{port}", "127.0.0.1", "127.0.0.1:1", "[::1]:{port}"]
)
def test_another_host_name_is_refused(bench: Bench, host: str) -> None:
    headers = {**bearer(bench), "Host": host.format(port=bench.port)}
    assert bench.client.get("/state", headers=headers).status_code == 421


def test_localhost_is_this_host(bench: Bench) -> None:
    headers = {**bearer(bench), "Host": f"localhost:{bench.port}"}
    assert bench.client.get("/state", headers=headers).status_code == 200


def test_two_host_names_or_none_are_refused(bench: Bench) -> None:
    token = f"Authorization: Bearer {bench.token}"
    assert b" 4" in raw(bench, request(bench, "/state", token, "Host: evil.example"))
    assert b" 4" in raw(bench, f"GET /state HTTP/1.1\r\n{token}\r\n\r\n".encode())
    assert b" 421 " in raw(bench, f"GET /state HTTP/1.0\r\n{token}\r\n\r\n".encode())


@pytest.mark.parametrize(
    "origin", ["http://evil.example", "null", "http://127.0.0.1:1", "https://127.0.0.1:{port}"]
)
def test_another_origin_is_refused(bench: Bench, origin: str) -> None:
    headers = {**bearer(bench), "Origin": origin.format(port=bench.port)}
    assert bench.client.post("/wishes", json={"command": "take"}, headers=headers).status_code == 403
    assert bench.client.get("/state", headers=headers).status_code == 403
    assert bench.board.next_wish(0.0) is None


@pytest.mark.parametrize("site", ["cross-site", "same-site"])
def test_a_browser_that_asks_for_another_page_is_refused(bench: Bench, site: str) -> None:
    for path in PATHS:
        headers = {**bearer(bench), "Sec-Fetch-Site": site}
        assert bench.client.get(path, headers=headers).status_code == 403
    sent = {**bearer(bench), "Sec-Fetch-Site": "same-origin"}
    assert bench.client.post("/wishes", json={"command": "take"}, headers=sent).status_code == 403


def test_the_pages_own_wish_arrives(bench: Bench) -> None:
    headers = {**bearer(bench), "Origin": bench.own, "Sec-Fetch-Site": "same-origin"}
    assert bench.client.post("/wishes", json={"command": "take"}, headers=headers).status_code == 200
    assert bench.board.next_wish(0.0) == Wish(Command.TAKE)


@pytest.mark.parametrize(
    "body", [b"", b"{", b"[]", b"null", b'{"command": 1}', b'{"command": "rm"}', b"\xff", b"[" * 900]
)
def test_a_wish_that_is_none_is_refused(bench: Bench, body: bytes) -> None:
    answer = bench.client.post("/wishes", content=body, headers=bearer(bench))
    assert answer.status_code == 400
    assert "take" in answer.text
    assert bench.board.next_wish(0.0) is None


@pytest.mark.parametrize("method", ["HEAD", "PUT", "DELETE", "OPTIONS", "PATCH", "TRACE", "BREW"])
def test_other_methods_are_refused(bench: Bench, method: str) -> None:
    assert bench.client.request(method, "/state", headers=bearer(bench)).status_code == 405


@pytest.mark.parametrize(
    "path",
    [
        "/../../etc/passwd",
        "/%2e%2e/%2e%2e/etc/passwd",
        "/pictures/../../etc/passwd",
        "/pictures/..%2f..%2fetc%2fpasswd",
        "/pictures/%2e%2e",
        "/pictures/left/",
        "/pictures/left%00.jpg",
        "/pictures/LEFT",
        "//etc/passwd",
        "/templates/live.js",
        "/state/",
        "/rig/..",
        "/\\..\\..\\secret",
        "/static/..;/..;/etc/passwd",
    ],
)
def test_path_tricks_find_nothing(bench: Bench, path: str) -> None:
    answer = raw(bench, request(bench, path, f"Authorization: Bearer {bench.token}", "Connection: close"))
    assert b" 404 " in answer or b" 400 " in answer


def test_a_full_address_in_the_request_line_changes_nothing(bench: Bench) -> None:
    line = request(bench, "http://evil.example/etc/passwd", f"Authorization: Bearer {bench.token}")
    assert b" 404 " in raw(bench, line)


def test_a_long_body_is_refused_by_its_stated_length(bench: Bench) -> None:
    sent = request(
        bench, "/wishes", f"Authorization: Bearer {bench.token}", f"Content-Length: {10**12}", method="POST"
    )
    assert b" 413 " in raw(bench, sent + b"{")


def test_a_long_body_without_a_stated_length_is_refused_while_it_comes(bench: Bench) -> None:
    sent = request(
        bench, "/wishes", f"Authorization: Bearer {bench.token}", "Transfer-Encoding: chunked", method="POST"
    )
    chunk = b"400\r\n" + b"x" * 0x400 + b"\r\n"
    assert b" 413 " in raw(bench, sent + chunk * (2 + MOST_BODY_BYTES // 0x400))  # never ends


def test_a_body_that_is_long_enough_is_read(bench: Bench) -> None:
    body = json.dumps({"command": "auto", "more": "x" * (MOST_BODY_BYTES - 40)})
    assert bench.client.post("/wishes", content=body, headers=bearer(bench)).status_code == 200
    assert bench.board.next_wish(0.0) == Wish(Command.AUTO)


def test_long_addresses_and_headers_are_refused(bench: Bench) -> None:
    token = f"Authorization: Bearer {bench.token}"
    long = "x" * MOST_TARGET_BYTES
    assert b" 414 " in raw(bench, request(bench, f"/state?after={long}", token))
    assert b" 431 " in raw(bench, request(bench, "/state", token, f"X-Long: {'x' * MOST_HEADER_BYTES}"))
    assert b" 400 " in raw(bench, request(bench, "/state", token, f"X-Long: {'x' * 300_000}"))


def test_a_web_socket_is_not_opened(bench: Bench) -> None:
    lines = (
        "Upgrade: websocket",
        "Connection: Upgrade",
        "Sec-WebSocket-Version: 13",
        "Sec-WebSocket-Key: eA",
    )
    assert b" 101 " not in raw(bench, request(bench, "/", f"Authorization: Bearer {bench.token}", *lines))


def test_the_server_is_on_this_computer_alone(bench: Bench) -> None:
    ports = [
        line.split()[1]
        for line in Path("/proc/net/tcp").read_text(encoding="ascii").splitlines()[1:]
        if line.split()[3] == "0A" and line.split()[1].endswith(f":{bench.port:04X}")
    ]
    assert ports == [f"0100007F:{bench.port:04X}"]


def test_a_port_that_is_in_use_is_an_error(bench: Bench) -> None:
    with pytest.raises(DeviceError, match=f"port {bench.port}"), served(Board(), bench.port):
        pass


def test_ten_megabytes_are_refused_before_they_have_come(bench: Bench) -> None:
    size = 10_000_000
    lines = (f"Authorization: Bearer {bench.token}", f"Content-Length: {size}", f"Origin: {bench.own}")
    assert b" 413 " in raw(bench, request(bench, "/wishes", *lines, method="POST") + b"x" * 4096)
    assert bench.board.next_wish(0.0) is None


def test_a_page_elsewhere_with_the_token_may_send_nothing_without_an_origin(bench: Bench) -> None:
    cookie = {f"labcal-{bench.port}": bench.token}
    with httpx.Client(base_url=bench.own, cookies=cookie) as client:
        for site in ("cross-site", "same-site", "none", "same-origin"):
            answer = client.post("/wishes", json={"command": "take"}, headers={"Sec-Fetch-Site": site})
            assert answer.status_code == 403
    assert bench.board.next_wish(0.0) is None


@pytest.mark.parametrize("path", PATHS)
def test_no_answer_lets_the_address_go_on_to_another_page(bench: Bench, path: str) -> None:
    for headers in (bearer(bench), {}):
        answer = bench.client.get(path, headers=headers)
        assert answer.headers["referrer-policy"] == "no-referrer"
        assert bench.token not in answer.text


@pytest.mark.parametrize("method", ["HEAD", "OPTIONS", "TRACE", "CONNECT", "POST"])
def test_without_the_token_no_method_tells_anything(bench: Bench, method: str) -> None:
    answer = raw(bench, request(bench, "/state", "Connection: close", method=method))
    assert b" 403 " in answer or b" 400 " in answer


@pytest.mark.parametrize(("method", "path"), [("POST", "/state"), ("POST", "/"), ("GET", "/wishes")])
def test_a_path_answers_its_own_method_alone(bench: Bench, method: str, path: str) -> None:
    headers = {**bearer(bench), "Origin": bench.own}
    assert bench.client.request(method, path, headers=headers).status_code == 405


@pytest.mark.parametrize("accept", ["text/event-stream", "*/*"])
def test_neither_events_nor_a_web_socket_without_the_token(bench: Bench, accept: str) -> None:
    assert bench.client.get("/state", headers={"Accept": accept}).status_code == 403
    lines = (
        "Upgrade: websocket",
        "Connection: Upgrade",
        "Sec-WebSocket-Version: 13",
        "Sec-WebSocket-Key: eA",
    )
    assert b" 403 " in raw(bench, request(bench, "/state", *lines))


def test_a_view_is_dropped_by_its_name_alone(bench: Bench) -> None:
    bench.board.show(taken=(ViewShown("view-001"),))
    for name in ("view-002", "", "../view-001", 1, None, ["view-001"], {"a": 1}):
        answer = bench.client.post("/wishes", json={"command": "drop", "view": name}, headers=bearer(bench))
        assert answer.status_code in {400, 404}
        assert bench.board.next_wish(0.0) is None
    given = {"command": "drop", "view": "view-001"}
    assert bench.client.post("/wishes", json=given, headers=bearer(bench)).status_code == 200
    assert bench.board.next_wish(0.0) == Wish(Command.DROP, "view-001")


def test_requests_that_never_end_do_not_shut_the_page_out(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As many connections as the server takes send a part of a head, and no more or a byte now and then."""
    monkeypatch.setattr(connection, "HEAD_S", 0.5)
    slow = [socket.create_connection(("127.0.0.1", bench.port), timeout=10) for _ in range(MOST_CONNECTIONS)]
    try:
        for number, one in enumerate(slow):
            one.sendall(b"GET /state HTTP/1.1\r\nX-Slow: " if number % 2 else b"")
        end = time.monotonic() + 10.0
        while httpx.get(f"{bench.own}/state", headers=bearer(bench)).status_code != 200:
            assert time.monotonic() < end
            for one in slow[1::2]:
                with contextlib.suppress(OSError):
                    one.sendall(b"x")
            time.sleep(0.1)
        assert all(one.recv(1) == b"" for one in slow[::2])
    finally:
        for one in slow:
            one.close()
