"""``labcal capture``: simulated, replayed and fake real cameras, from the command line."""

import json
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from labcal import examples
from labcal.cli.status import ExitStatus
from labcal.shoot.dataset import open_shoot

Run = Callable[..., Any]
ARAVIS = shutil.which("arv-fake-gv-camera-0.8")
TWO_CAMERAS = """
set -eu
ip link set lo up
ip addr add 127.0.0.2/8 dev lo
ip addr add 127.0.0.3/8 dev lo
arv-fake-gv-camera-0.8 -i 127.0.0.2 -s CAM-A > /dev/null 2>&1 & first=$!
arv-fake-gv-camera-0.8 -i 127.0.0.3 -s CAM-B > /dev/null 2>&1 & second=$!
trap 'kill $first $second 2> /dev/null || true' EXIT
sleep 1
take() {
  "$PYTHON" -m labcal capture left=genicam:CAM-A right=genicam:CAM-B --interval-s 0 --timeout-s 3 "$@"
}
take --views 100 -o whole --json > whole.json
take --views 1000 -o cut --json > cut.json 2> cut.txt & capture=$!
for _ in $(seq 600); do
  if [ "$(ls cut/images 2> /dev/null | wc -l)" -ge 10 ]; then break; fi
  sleep 0.1
done
kill -9 $second
status=0
wait $capture || status=$?
echo $status > status.txt
"""


def test_a_captured_scene_is_the_rendered_one(labcal: Run, tmp_path: Path) -> None:
    rendered, captured = tmp_path / "rendered", tmp_path / "captured"
    scene = "webcam-plane"
    small = ("--set", "spp=4")
    assert labcal("render", scene, *small, "-o", rendered, "--views", 1, "--workers", 1).status == 0
    done = labcal("capture", f"sim:{scene}", *small, "-o", captured, "--views", 1)
    assert done.status == ExitStatus.DONE
    assert (done.document["views"], done.document["images"], done.document["refused"]) == (1, 2, [])
    first = {path.name: path.read_bytes() for path in (rendered / "images").iterdir()}
    assert {path.name: path.read_bytes() for path in (captured / "images").iterdir()} == first
    one, other = open_shoot(rendered), open_shoot(captured)
    assert one.manifest == other.manifest
    again = labcal(
        "capture", f"folder:{captured}", "--target", other.target.name, "-o", tmp_path / "replayed"
    )
    assert again.status == ExitStatus.DONE
    assert open_shoot(tmp_path / "replayed").manifest == one.manifest


@pytest.mark.parametrize(
    ("words", "status", "said"),
    [
        (("uvc:front",), ExitStatus.UNUSABLE, "by its number"),
        (("usb:0",), ExitStatus.UNUSABLE, "kind of source"),
        (("sim:nowhere",), ExitStatus.UNUSABLE, "no scene"),
        (("sim:webcam-plane", "uvc:0"), ExitStatus.UNUSABLE, "alone"),
        (("folder:nowhere",), ExitStatus.UNUSABLE, "nowhere"),
        (("video:nowhere.mp4",), ExitStatus.UNUSABLE, "nowhere.mp4"),
        (("uvc:77",), ExitStatus.FAILED, "uvc:77"),
        (("uvc:0", "--interval-s", "-1"), ExitStatus.UNUSABLE, "interval"),
    ],
)
def test_bad_sources_are_named_and_nothing_is_written(
    labcal: Run, tmp_path: Path, words: tuple[str, ...], status: ExitStatus, said: str
) -> None:
    told = labcal("capture", *words, "-o", tmp_path / "shoot")
    assert told.status == status
    assert said in told.said
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
@pytest.mark.skipif(ARAVIS is None, reason="needs Debian's package aravis-tools")
def test_two_cameras_of_aravis_deliver_pairs_and_one_that_dies_is_named(tmp_path: Path) -> None:
    pytest.importorskip("viva_genicam")
    script = tmp_path / "two.sh"
    script.write_text(TWO_CAMERAS)
    ran = subprocess.run(
        ["unshare", "-rn", "bash", str(script)],  # noqa: S607 -- of the PATH below
        cwd=tmp_path,
        env={
            "PATH": "/usr/sbin:/sbin:/usr/bin:/bin",
            "PYTHON": sys.executable,
            "PYTHONPATH": ":".join(sys.path),
        },
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    if "unshare" in ran.stderr and "not permitted" in ran.stderr:
        pytest.skip("no network namespaces here")
    assert ran.returncode == 0, ran.stderr
    assert json.loads((tmp_path / "whole.json").read_text())["views"] == 100
    assert len(open_shoot(tmp_path / "whole").views()) == 100
    assert (tmp_path / "status.txt").read_text().strip() == str(ExitStatus.FAILED.value)
    assert "CAM-B" in (tmp_path / "cut.txt").read_text()
    cut = open_shoot(tmp_path / "cut")
    assert len(cut.views()) >= 5
    assert all((cut.folder / path).is_file() for view in cut.views() for path in view.images.values())


@pytest.mark.slow
def test_a_simulated_hand_follows_the_guide_until_the_error_is_reached(labcal: Run, tmp_path: Path) -> None:
    words = ("capture", "sim:webcam-handheld", "--set", "spp=4", "--guided", "--wanted-mm", 0.9)
    done = labcal(*words, "--views", 8, "-o", tmp_path / "shoot")
    assert done.status == ExitStatus.DONE, done.said
    told, guided = done.document, done.document["guided"]
    assert guided["done"]
    assert guided["reached_mm"] <= 0.9
    assert 4 <= told["views"] == guided["usable_views"] <= 8
    assert "its top tilted away" in done.said
    assert len(open_shoot(tmp_path / "shoot").views()) == told["views"]


def test_a_guided_capture_of_a_shoot_takes_its_target(labcal: Run, tmp_path: Path) -> None:
    shoot = examples.shoot(tmp_path / "shoot")
    done = labcal("capture", f"folder:{shoot.folder}", "--guided", "-o", tmp_path / "again")
    assert done.status == ExitStatus.DONE, done.said
    assert done.document["guided"]["usable_views"] == done.document["views"] == len(shoot.views())
    assert "code" not in done.said
    assert open_shoot(tmp_path / "again").target == shoot.target


def test_options_of_a_guided_capture_need_one(labcal: Run, tmp_path: Path) -> None:
    done = labcal("capture", "sim:webcam-handheld", "--wanted-mm", 0.9, "-o", tmp_path / "shoot")
    assert done.status == ExitStatus.UNUSABLE
    assert "Only guided captures have --wanted-mm. Add --guided" in done.said


def test_a_page_guides_in_any_case_and_says_so(labcal: Run, tmp_path: Path) -> None:
    words = ("capture", "sim:webcam-handheld", "--guided", "--page", "--on-enter", "-o", tmp_path / "shoot")
    done = labcal(*words)  # which ends before anything is rendered
    assert done.status == ExitStatus.UNUSABLE
    assert "the page guides in any case" in done.said
