"""Pictures that cannot be used are diagnosed all the same."""

import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from labcal.cli import main
from labcal.errors import InputError
from labcal.pipeline import diagnose


def pictures(folder: Path, level: float, spread: float) -> Path:
    """Write pictures of noise of two cameras."""
    random = np.random.default_rng(0)
    folder.mkdir()
    for name in ("v0_a", "v0_b", "v1_a", "v1_b", "v2_a", "v2_b"):
        noise = np.clip(random.normal(level, spread, (240, 320)), 0.0, 255.0)
        cv2.imwrite(str(folder / f"{name}.png"), noise.astype(np.uint8))
    return folder


@pytest.mark.parametrize(("level", "spread", "check"), [(128.0, 3.0, "wrong-target"), (4.0, 2.0, "exposure")])
def test_pictures_without_a_target_have_a_finding_and_status_2(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], level: float, spread: float, check: str
) -> None:
    folder = str(pictures(tmp_path / "photos", level, spread))
    asked = ["diagnose", folder, "--target", "rings-10x8", "--cameras", "_a=a,_b=b"]
    assert main([*asked, "--json"]) == 2
    found = json.loads(capsys.readouterr().out)
    assert {one["check"] for one in found["findings"]} == {check}
    assert [one["check"] for one in found["explained"]] == ["too-few-views"]
    assert len(found["refused"]) == 6
    assert all(one["reason"].startswith("no-dots") for one in found["refused"])
    why = {one["check"]: one["why"] for one in found["not_judged"]}
    assert "two cameras" not in why["poor-coverage"]
    assert main(asked) == 2
    assert "Left out, 6 of 6 pictures" in capsys.readouterr().out


def test_a_video_is_refused_with_the_way_to_its_pictures(tmp_path: Path) -> None:
    video = tmp_path / "v.mp4"
    video.write_bytes(b"no video")
    with pytest.raises(InputError, match="from the source video:"):
        diagnose(video, "rings-10x8")
