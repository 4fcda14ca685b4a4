from pathlib import Path

import numpy as np
import pytest

from labcal.capture.stage import HEADER, read_stage
from labcal.errors import InputError
from labcal.shoot.manifest import Role

HEAD = ",".join(HEADER)


def written(path: Path, *lines: str) -> Path:
    path.write_text("\n".join([HEAD, *lines]) + "\n", encoding="utf-8")
    return path


def test_readings_are_poses_with_rotations_about_fixed_axes(tmp_path: Path) -> None:
    near, far = read_stage(written(tmp_path / "p.csv", "near,train,1,2,3,0,0,90", "far,test,0,0,10,90,0,90"))
    assert (near.view, near.role, far.role) == ("near", Role.TRAIN, Role.TEST)
    assert near.T_world_target == pytest.approx(
        np.array([[0.0, -1.0, 0.0, 1.0], [1.0, 0.0, 0.0, 2.0], [0.0, 0.0, 1.0, 3.0], [0.0, 0.0, 0.0, 1.0]])
    )
    # First about x, then about z: the target's y is turned to z and stays there, its x is turned to y.
    assert far.T_world_target[:3, :3] == pytest.approx(
        np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    )


@pytest.mark.parametrize(
    ("lines", "why"),
    [
        ((), "no poses"),
        (("a b,train,0,0,0,0,0,0",), "Line 2"),
        (("a,both,0,0,0,0,0,0",), "train or test"),
        (("a,train,0,0,0,0,0,nan",), "numbers"),
        (("a,train,0,1_0,0,0,0,0",), "numbers"),
        (("a,train,0,\x1c10,0,0,0,0",), "numbers|control|damaged|Line 2"),
        (("a,train,0,0,0,0,0,0", "a,train,1,0,0,0,0,0"), "two lines"),
        (("a,train,0,0,0,0,0,0", "A,train,1,0,0,0,0,0"), "capital"),
        (("a,train,0,0,0",), "Line 2"),
    ],
)
def test_damaged_readings_are_refused_by_line(tmp_path: Path, lines: tuple[str, ...], why: str) -> None:
    with pytest.raises(InputError, match=why):
        read_stage(written(tmp_path / "p.csv", *lines))
