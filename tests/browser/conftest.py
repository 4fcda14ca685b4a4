"""One real browser for all tests, and pages to open in it.

The browser is the system's Chromium. Where there is none, tests skip; in CI they fail.
"""

import os
import shutil
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from made_up_distortion import made_up_findings

from labcal import examples, pipeline
from labcal.bench.distortion.page.page import distortion_page
from labcal.report.reproduction import Reproduction
from labcal.report.reproduction_page import reproduction_page
from labcal.shoot.pictures import write_picture

NAMES = ("chromium", "chromium-browser", "google-chrome")


def _missing(reason: str) -> None:
    """Skip, but in CI, which must have a browser."""
    if os.environ.get("CI") == "true":
        pytest.fail(reason)
    pytest.skip(reason)


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    """Return a running browser."""
    try:
        from playwright.sync_api import sync_playwright  # noqa: PLC0415 -- not everybody has it
    except ModuleNotFoundError:
        _missing("playwright is not installed: pip install 'labcal[browser]'")
    path = next(filter(None, map(shutil.which, NAMES)), None)
    if path is None:
        _missing("there is no Chromium: apt-get install chromium")
    with sync_playwright() as playwright:
        running = playwright.chromium.launch(executable_path=path, args=["--no-sandbox"])  # of root's
        first = running.new_page()  # its processes start with it, which no page of ours is to wait for
        first.goto("about:blank")
        first.close()
        yield running
        running.close()


@pytest.fixture(scope="session")
def compiled_detector(tmp_path_factory: pytest.TempPathFactory) -> None:
    """Have the detector compiled before a page waits for it: half a minute, much longer on a busy machine."""
    shoot = examples.shoot(tmp_path_factory.mktemp("compiled") / "shoot", views=1)
    pipeline.detect(shoot)


@dataclass
class Opened:
    """A page, and what went wrong in it."""

    page: Any
    errors: list[str] = field(default_factory=list)
    """Of the console, and exceptions."""
    requests: list[str] = field(default_factory=list)
    """For anything but the file itself."""


Open = Callable[..., Opened]


@pytest.fixture
def open_page(browser: Any) -> Iterator[Open]:  # noqa: ANN401 -- playwright may be missing
    """Return what opens a file without a network; ``width`` in px, ``theme`` is light or dark."""
    contexts = []

    def opened(path: Path, width: int = 1200, theme: str = "light") -> Opened:
        context = browser.new_context(
            viewport={"width": width, "height": 900}, color_scheme=theme, offline=True
        )
        contexts.append(context)
        found = Opened(context.new_page())
        found.page.on("console", lambda said: said.type == "error" and found.errors.append(said.text))
        found.page.on("pageerror", lambda error: found.errors.append(str(error)))
        found.page.on(
            "request",
            lambda asked: asked.url.startswith(("http", "ws", "ftp")) and found.requests.append(asked.url),
        )
        found.page.goto(path.as_uri(), wait_until="load")
        return found

    yield opened
    for context in contexts:
        context.close()


@pytest.fixture(scope="session")
def calibration_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page of a calibration from dots of eight views; two of the pictures are there."""
    folder = tmp_path_factory.mktemp("calibration")
    path = folder / "calibration.html"
    pipeline.calibrate(examples.TARGET, examples.detections(), page=path)
    return path


@pytest.fixture(scope="session")
def evaluation_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page of the errors of points."""
    path = tmp_path_factory.mktemp("evaluation") / "errors.html"
    pipeline.evaluate(examples.points(), examples.TARGET, rig=examples.rig(), page=path)
    return path


@pytest.fixture(scope="session")
def certificate_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The certificate of a rig, with the SHA-256 of its file."""
    folder = tmp_path_factory.mktemp("certificate")
    examples.rig().save(folder / "rig.json")
    path = folder / "certificate.html"
    pipeline.certify(examples.pixels(), examples.lengths(), rig=folder / "rig.json", page=path)
    return path


@pytest.fixture(scope="session")
def comparison_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page of the difference of two calibrations, of four views each."""
    dots = examples.detections()
    rigs = [
        pipeline.calibrate(examples.TARGET, dots, hold_out=held).rig
        for held in (dots.views[:4], dots.views[4:])
    ]
    path = tmp_path_factory.mktemp("comparison") / "comparison.html"
    pipeline.compare(*rigs, page=path)
    return path


@pytest.fixture(scope="session")
def check_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page of the check of a calibration."""
    rig = pipeline.calibrate(examples.TARGET, examples.detections()).rig
    folder = tmp_path_factory.mktemp("check")
    settings = pipeline.CheckSettings(log=folder / "checks.jsonl", temperature_c=21.5)
    pipeline.check(rig, examples.detections(), examples.TARGET, settings, page=folder / "check.html")
    return folder / "check.html"


@pytest.fixture(scope="session")
def inspection_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page of a shoot, one of whose pictures cannot be read."""
    folder = tmp_path_factory.mktemp("inspection")
    shoot = examples.shoot(folder / "shoot")
    (shoot.folder / "images" / "hand-1_left.png").write_bytes(b"no picture")
    pipeline.inspect(shoot, page=folder / "sheet.html")
    return folder / "sheet.html"


@pytest.fixture
def reproduction_file(tmp_path: Path, made_up: Reproduction) -> Path:
    """The page of the paper's rows, with invented figures."""
    (tmp_path / "shoots").mkdir()
    write_picture(tmp_path / "shoots" / "a.png", np.full((480, 640, 3), 90, np.uint8))
    path = tmp_path / "index.html"
    path.write_text(reproduction_page(made_up, tmp_path), encoding="utf-8")
    return path


FAULTS = "faults=pitch-0.001,bend-1"


@pytest.fixture(scope="session")
def distortion_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page of the benchmark of distortion, with invented figures of nine methods and two layouts."""
    few = ("families=brown,water", "strengths=0,0.4,1", "noise_px=0.02,0.1", "points=60,140", FAULTS)
    path = tmp_path_factory.mktemp("distortion") / "index.html"
    path.write_text(distortion_page(made_up_findings("full", few, 2)).text(), encoding="utf-8")
    return path
