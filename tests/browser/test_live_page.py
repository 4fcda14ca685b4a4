"""The live page of a capture in a real browser, from opening it to the calibrated rig."""

import json
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest
from live_commands import LiveCommand, live_command, live_page
from live_stand_ins import LiveCameras

from labcal.capture.addresses import parse_address, source_at
from labcal.capture.capturing import CaptureRun, capture_shoot
from labcal.capture.preview import Previewed
from labcal.capture.settings import CaptureSettings, SourceSettings
from labcal.capture.simulated import SimulatedCameras
from labcal.errors import DeviceError
from labcal.live.board import Board
from labcal.live.operator import Operator
from labcal.live.server import served
from labcal.run.progress import NoProgress

pytestmark = pytest.mark.usefixtures("compiled_detector")
SCENE = ("sim:webcam-handheld", "--set", "spp=4")
LEAST_RATE = 5.0
MEGAPIXEL = (1280, 960)
MINUTE_S, REQUESTS = 60.0, 1000
MOST_GROWTH_MB = 4.0


@pytest.fixture
def running(tmp_path: Path) -> Iterator[LiveCommand]:
    """A capture of simulated cameras on the page."""
    with live_command(tmp_path, SCENE) as begun:
        yield begun


@pytest.mark.slow
def test_from_opening_the_page_to_the_calibrated_rig(running: LiveCommand, browser: Any) -> None:  # noqa: ANN401
    context = browser.new_context(viewport={"width": 820, "height": 1180})
    opened = live_page(context, running.address)
    page, errors = opened.page, opened.errors
    assert "token" not in page.url
    assert page.is_disabled("#finish")
    page.wait_for_selector(".camera.found", timeout=120_000)
    assert page.evaluate("document.querySelectorAll('.outline').length") >= 1
    page.keyboard.press("Space")
    page.wait_for_selector("body[data-views='1']", timeout=60_000)
    page.check("#auto")
    end = time.monotonic() + 240
    while int(page.get_attribute("body", "data-views")) < 6:
        assert time.monotonic() < end
        time.sleep(0.5)
    page.uncheck("#auto")
    page.click("#finish", timeout=60_000)
    page.wait_for_selector("body[data-phase=done]", timeout=240_000)
    assert "calibrated" in page.inner_text("#sentence")
    assert "shoot-rig.json" in page.inner_text("#files")
    assert errors == []
    with context.expect_page() as opening:
        page.click("#rig")
    rig = opening.value
    rig.wait_for_selector("h1")
    assert rig.inner_text("h1") == "Calibration of left, right"
    page.click("button[data-command=close]")
    document = running.ended()
    context.close()
    assert document["views"] >= 6
    assert document["rig"] == "shoot-rig.json"
    assert json.loads((running.folder / "shoot-rig.json").read_text(encoding="utf-8"))["cameras"].keys() == {
        "left",
        "right",
    }
    assert (running.folder / "shoot-rig.html").is_file()


@pytest.mark.slow
def test_requests_leave_the_memory_as_it_is(running: LiveCommand) -> None:
    base, token = running.address.split("/?token=")
    with httpx.Client(base_url=base, headers={"Authorization": f"Bearer {token}"}, timeout=60) as client:
        while client.get("/state").json()["phase"] != "aim":
            time.sleep(0.2)
        paths = ("/pictures/left", "/pictures/right", "/state", "/", "/nothing")
        began, memory = time.monotonic(), list[float]()
        for number in range(REQUESTS):
            client.get(paths[number % len(paths)])
            if number % (REQUESTS // 20) == 0:
                memory.append(running.memory_mb())
            time.sleep(max(0.0, began + number * MINUTE_S / REQUESTS - time.monotonic()))
    assert running.process.poll() is None
    assert memory[-1] - memory[len(memory) // 3] < MOST_GROWTH_MB


@pytest.fixture(scope="module")
def scenes() -> tuple[SimulatedCameras, dict[str, list[np.ndarray]]]:
    """Pictures of two cameras of a megapixel, each with noise of its own."""
    size = f"[{MEGAPIXEL[0]},{MEGAPIXEL[1]}]"
    changes = ("spp=4", f"cameras.left.size={size}", f"cameras.right.size={size}")
    source = source_at(parse_address(SCENE[0]), SourceSettings(overrides=changes))
    assert isinstance(source, SimulatedCameras)
    source.open()
    looks = [source.peek() for _ in range(3)]
    assert all(looks)
    names = list(looks[0].frames)  # type: ignore[union-attr]
    return source, {name: [look.frames[name].picture for look in looks if look] for name in names}


@pytest.mark.slow
def test_pictures_of_two_megapixel_cameras_are_new_five_times_a_second(
    tmp_path: Path,
    browser: Any,  # noqa: ANN401
    scenes: tuple[SimulatedCameras, dict[str, list[np.ndarray]]],
) -> None:
    board, cameras, target = Board(), LiveCameras(scenes[1]), scenes[0].scene.target
    source = Previewed(cameras)
    operator = Operator(board, source, target, lambda: True)
    run = CaptureRun("capture test", target, (), CaptureSettings(), None, attendant=operator)

    def work() -> None:
        with pytest.raises(DeviceError):
            capture_shoot(source, tmp_path / "shoot", run, NoProgress())

    thread = threading.Thread(target=work)
    thread.start()
    with served(board) as page:
        context = browser.new_context(viewport={"width": 820, "height": 1180})
        opened = context.new_page()
        opened.goto(page.address)
        opened.wait_for_selector(".camera.found", timeout=120_000)
        opened.evaluate("Object.values(drawn).forEach((one) => { one.times = []; })")
        time.sleep(5.0)
        rates = opened.evaluate("state.cameras.map((camera) => rate(camera.name))")
        context.close()
    cameras.unplugged = True
    thread.join(30)
    operator.close()
    assert min(rates) >= LEAST_RATE
