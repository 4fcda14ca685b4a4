"""At the bench: views taken back, two browsers, a page loaded again, Ctrl-C, files that come late."""

from pathlib import Path
from typing import Any

import pytest
from live_commands import STEP_S, LivePage, live_command, live_page, until

from labcal import examples
from labcal.shoot.dataset import open_shoot
from labcal.shoot.pictures import SUFFIXES

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("compiled_detector")]
PHONE = {"width": 390, "height": 844}
MOST_BAR = 0.16
"""Share of a phone's height that the bar of buttons may take."""
INTERRUPTED = 130


def images(folder: Path) -> set[str]:
    return {path.name for path in (folder / "images").iterdir() if path.suffix in SUFFIXES}


def names(folder: Path) -> list[str]:
    return [view.name for view in open_shoot(folder).views()]


def take_out(bench: LivePage, view: str) -> None:
    """Press the button beside a view twice: it asks once."""
    bench.page.click("#taken:not([open]) summary")
    button = bench.page.get_by_label(f"Take out {view}", exact=True)
    button.click(timeout=1e3 * STEP_S)
    assert button.inner_text() == "Delete it?"
    button.click(timeout=1e3 * STEP_S)


def test_views_are_taken_back_before_two_browsers_and_ctrl_c_leaves_a_shoot(
    tmp_path: Path,
    browser: Any,  # noqa: ANN401 -- playwright may be missing
) -> None:
    shoot = tmp_path / "shoot"
    with live_command(tmp_path, ["sim:webcam-handheld", "--set", "spp=1"]) as running:
        tablet, phone = browser.new_context(), browser.new_context(viewport=PHONE, color_scheme="dark")
        first, second = live_page(tablet, running.address), live_page(phone, running.address)
        for _ in range(3):
            first.take()
        second.until_views(3)
        before = first.taken
        assert before == second.taken == names(shoot)

        first.page.click("#undo", timeout=1e3 * STEP_S)
        second.until_views(2)
        until(lambda: second.taken == before[:2])
        assert names(shoot) == before[:2]
        take_out(second, before[0])
        first.until_views(1)
        assert names(shoot) == before[1:2]
        until(lambda: {name.rpartition("_")[0] for name in images(shoot)} == {before[1]})

        first.page.reload()
        first.until_phase("aim")
        assert first.taken == before[1:2]
        first.page.click("#auto")
        second.page.wait_for_selector("#auto:checked", timeout=1e3 * STEP_S)
        second.page.click("#auto")
        first.page.wait_for_selector("#auto:not(:checked)", timeout=1e3 * STEP_S)

        box = second.page.locator("#bar").bounding_box()
        assert box["height"] <= MOST_BAR * PHONE["height"]
        assert second.page.evaluate("document.documentElement.scrollWidth") == PHONE["width"]
        cut = "(all) => all.filter((one) => one.scrollWidth > one.clientWidth + 1).map((one) => one.id)"
        assert second.page.locator("#bar > *").evaluate_all(cut) == []

        kept = names(shoot)
        running.interrupt()
        for bench in (first, second):
            bench.until_phase("failed")
            assert "Ctrl-C" in bench.page.inner_text("#request")
            assert "goes on with it" in bench.page.inner_text("#error")
        assert running.process.wait(STEP_S) == INTERRUPTED
        assert names(shoot)[: len(kept)] == kept
        assert first.errors == second.errors == []
        for context in (tablet, phone):
            context.close()


def test_pictures_dropped_into_a_folder_become_views_and_a_missing_one_is_named(
    tmp_path: Path,
    browser: Any,  # noqa: ANN401 -- playwright may be missing
) -> None:
    drawn = examples.shoot(tmp_path / "drawn", views=3)
    drop = tmp_path / "drop"
    drop.mkdir()
    words = ["watch:drop", "--target", examples.TARGET, "--cameras", "_left=left,_right=right"]
    with live_command(tmp_path, [*words, "--timeout-s", "2"]) as running:
        context = browser.new_context()
        bench = live_page(context, running.address)
        bench.page.wait_for_selector("#notice:visible", timeout=1e3 * STEP_S)  # nothing comes: it says so
        assert bench.page.is_checked("#auto")
        assert bench.views == 0
        for number, view in enumerate(drawn.views()[:2], 1):
            halves = []
            for image in view.images.values():
                data = (drawn.folder / image).read_bytes()
                file = (drop / Path(image).name).open("wb")
                file.write(data[: len(data) // 2])
                file.flush()
                halves.append((file, data[len(data) // 2 :]))
            bench.page.wait_for_timeout(800)  # longer than a file has to stand still
            assert bench.views == number - 1
            for file, rest in halves:
                file.write(rest)
                file.close()
            bench.until_views(number)
        lonely = drawn.folder / drawn.views()[2].images["left"]
        (drop / lonely.name).write_bytes(lonely.read_bytes())
        bench.page.locator("#notice", has_text="right").wait_for(timeout=1e3 * STEP_S)
        assert bench.views == 2
        right = drawn.folder / drawn.views()[2].images["right"]
        (drop / right.name).write_bytes(right.read_bytes())
        bench.until_views(3)
        bench.page.wait_for_selector("#notice", state="hidden", timeout=1e3 * STEP_S)
        running.interrupt()
        bench.until_phase("failed")
        assert running.process.wait(STEP_S) == INTERRUPTED
        assert bench.errors == []
        context.close()
    assert len(names(tmp_path / "shoot")) == 3
