"""Pages in a real browser: readable at once, quiet, within reach of everybody, and the 3-D view turns."""

import csv
import io
import os
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from playwright.sync_api import Page

MOST_BYTES = 10_000_000
READABLE_S, SPACE_S = 2.0, 6.0
PHONE = 375
Open = Callable[..., Any]
FILES = (
    "calibration_file",
    "evaluation_file",
    "inspection_file",
    "reproduction_file",
    "distortion_file",
    "certificate_file",
    "comparison_file",
    "check_file",
)


def processor_seconds() -> float:
    """Return the processor time of all processes below this one, s."""
    ticks = os.sysconf("SC_CLK_TCK")
    parents, spent = {}, {}
    for entry in Path("/proc").glob("[0-9]*"):
        try:
            fields = (entry / "stat").read_text().rpartition(")")[2].split()
        except OSError:  # it has ended
            continue
        parents[int(entry.name)], spent[int(entry.name)] = int(fields[1]), int(fields[11]) + int(fields[12])
    mine = {os.getpid()}
    while more := {pid for pid, parent in parents.items() if parent in mine} - mine:
        mine |= more
    return sum(spent.get(pid, 0) for pid in mine) / ticks


class Stopwatch:
    """Seconds; on a machine that is busy with other work those of the processors, where they are fewer."""

    def __init__(self) -> None:
        self._began, self._spent = time.monotonic(), processor_seconds()

    @property
    def seconds(self) -> float:
        return min(time.monotonic() - self._began, processor_seconds() - self._spent)


OFTEN = ("calibration_file", "reproduction_file", "distortion_file", "certificate_file")
ALL = [pytest.param(file, marks=[] if file in OFTEN else pytest.mark.slow) for file in FILES]


@pytest.mark.parametrize("file", ALL)
def test_a_page_is_readable_at_once_and_fetches_nothing(
    file: str, open_page: Open, request: pytest.FixtureRequest
) -> None:
    path = request.getfixturevalue(file)
    assert path.stat().st_size < MOST_BYTES
    watch = Stopwatch()
    opened = open_page(path)
    page = opened.page
    assert page.locator("h1").is_visible()
    assert page.locator("table").first.is_visible()
    assert page.locator("figure svg, figure img").first.is_visible()
    assert watch.seconds < READABLE_S
    assert opened.errors == []
    assert opened.requests == []
    assert page.evaluate("typeof Plotly") == "undefined"  # nothing that is not asked for runs


def eye(page: "Page") -> dict[str, float]:
    """Return where the 3-D view is seen from."""
    found: dict[str, float] = page.evaluate("document.querySelector('.space-drawn').layout.scene.camera.eye")
    return found


def started(open_page: Open, path: Path, theme: str) -> "Page":
    opened = open_page(path, theme=theme)
    opened.page.get_by_role("button", name="Turn it in 3-D").click()
    opened.page.locator(".controls").wait_for(state="visible", timeout=60_000)
    page: Page = opened.page
    return page


def test_the_3d_view_starts_when_asked_and_turns(open_page: Open, calibration_file: Path) -> None:
    opened = open_page(calibration_file)
    page = opened.page
    watch = Stopwatch()
    page.get_by_role("button", name="Turn it in 3-D").click()
    page.locator(".controls").wait_for(state="visible", timeout=60_000)
    assert watch.seconds < SPACE_S
    seen = [eye(page)]
    for name in ("Front", "Top", "Side", "Camera left", "Camera right", "Turn to the left", "Nearer"):
        page.get_by_role("button", name=name).click()
        page.wait_for_function(
            "old => JSON.stringify(document.querySelector('.space-drawn').layout.scene.camera.eye) !== old",
            arg=page.evaluate("eye => JSON.stringify(eye)", seen[-1]),
        )
        seen.append(eye(page))
    # Seen from a camera, the eye is where that camera is: the left one in the world's origin.
    axes = page.evaluate(
        "(({xaxis, yaxis, zaxis}) => [xaxis, yaxis, zaxis].map(a => a.range))"
        "(document.querySelector('.space-drawn').layout.scene)"
    )
    longest = max(high - low for low, high in axes)
    for name, (low, high) in zip("xyz", axes, strict=True):
        assert seen[4][name] == pytest.approx(-0.5 * (low + high) / longest, abs=1e-3)
    page.keyboard.press("ArrowRight")  # the view has the focus since it started; buttons take it
    page.locator(".stage").focus()
    page.keyboard.press("ArrowRight")
    assert eye(page) != seen[-1]
    before = eye(page)
    box = page.locator(".space-drawn").bounding_box()
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    page.mouse.down()
    page.mouse.move(box["x"] + box["width"] / 2 + 120, box["y"] + box["height"] / 2 + 60, steps=6)
    page.mouse.up()
    page.wait_for_function(
        "old => JSON.stringify(document.querySelector('.space-drawn').layout.scene.camera.eye) !== old",
        arg=page.evaluate("eye => JSON.stringify(eye)", before),
    )
    page.get_by_label("error vectors").uncheck()
    shown = page.evaluate("document.querySelector('.space-drawn').data.map(t => [t.meta, t.visible])")
    assert [layer for layer, visible in shown if visible is False] == ["error vectors"]
    assert opened.errors == []
    assert opened.requests == []


@pytest.mark.parametrize(
    ("file", "theme"),
    [
        ("calibration_file", "light"),
        *[pytest.param(file, "light", marks=pytest.mark.slow) for file in FILES[1:]],
        *[pytest.param(file, "dark", marks=pytest.mark.slow) for file in FILES],
    ],
)
def test_everybody_can_use_a_page(
    file: str, theme: str, open_page: Open, request: pytest.FixtureRequest
) -> None:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright")
    page = open_page(request.getfixturevalue(file), theme=theme).page
    page.evaluate("document.querySelectorAll('details').forEach(one => one.open = true)")
    found = axe.Axe().run(page).response["violations"]
    assert [
        (one["id"], [node["html"][:120] for node in one["nodes"]])
        for one in found
        if one["impact"] in ("serious", "critical")
    ] == []


@pytest.mark.slow
def test_everybody_can_use_the_3d_view(open_page: Open, calibration_file: Path) -> None:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright")
    page = started(open_page, calibration_file, theme="dark")
    found = axe.Axe().run(page).response["violations"]
    assert [one["id"] for one in found if one["impact"] in ("serious", "critical")] == []


@pytest.mark.parametrize("file", ALL)
def test_a_phone_scrolls_no_page_sideways(file: str, open_page: Open, request: pytest.FixtureRequest) -> None:
    page = open_page(request.getfixturevalue(file), width=PHONE).page
    assert page.evaluate("document.documentElement.scrollWidth") == PHONE


def test_print_is_black_on_white_without_buttons(open_page: Open, calibration_file: Path) -> None:
    page = open_page(calibration_file, theme="dark").page
    dark = page.evaluate("getComputedStyle(document.body).backgroundColor")
    page.emulate_media(media="print")
    assert dark != "rgb(255, 255, 255)"
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
    assert not page.get_by_role("button", name="Turn it in 3-D").is_visible()
    assert page.locator("#space svg").is_visible()


def test_figures_and_numbers_are_saved(open_page: Open, calibration_file: Path) -> None:
    page = open_page(calibration_file).page
    with page.expect_download() as caught:
        page.get_by_role("button", name="Save residuals-left.csv").click()
    lines = list(csv.DictReader(io.StringIO(Path(caught.value.path()).read_text())))
    assert caught.value.suggested_filename == "residuals-left.csv"
    assert len(lines) == 704
    assert list(lines[0]) == ["view", "x_px", "y_px", "residual_x_px", "residual_y_px", "outlier"]
    with page.expect_download() as caught:
        page.get_by_role("button", name="Save residuals-left.svg").click()
    svg = Path(caught.value.path()).read_text()
    assert svg.startswith("<svg")
    assert 'xmlns="http://www.w3.org/2000/svg"' in svg
    assert "var(--" not in svg


def test_the_cells_of_a_benchmark_are_saved(open_page: Open, distortion_file: Path) -> None:
    page = open_page(distortion_file).page
    with page.expect_download() as caught:
        page.get_by_role("button", name="Save cells.csv").click()
    lines = list(csv.DictReader(io.StringIO(Path(caught.value.path()).read_text())))
    assert {line["method"] for line in lines} >= {"hybrid", "mlp-bayes", "affine"}
    usual, faulty = 9 * 2 * 3 * 2 * 2 * 2 * 2, 9 * 2 * 2 * 2
    assert len(lines) == usual + faulty


def test_keys_reach_every_control(open_page: Open, calibration_file: Path) -> None:
    page = open_page(calibration_file).page
    reached = set()
    for _ in range(60):
        page.keyboard.press("Tab")
        reached.add(
            page.evaluate(
                "(one => one.getAttribute('aria-label') || one.textContent.trim())(document.activeElement)"
            )
        )
    assert {"Skip to the content", "Turn it in 3-D", "Save residuals-left.csv"} <= reached
