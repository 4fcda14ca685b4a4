"""truth.json and dots.csv."""

import json
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

from labcal.cameras.camera import Camera
from labcal.cameras.record import CameraRecord, matrix4_record
from labcal.errors import InputError
from labcal.shoot.truth import (
    TrueDots,
    TruePicture,
    TrueView,
    Truth,
    has_truth,
    read_true_dots,
    read_truth,
    write_truth,
)

HEADER = "view,camera,col,row,X_mm,Y_mm,Z_mm,centre_x_px,centre_y_px,centroid_x_px,centroid_y_px,visible"


def some_dots(view: str, camera: str) -> TrueDots:
    rng = np.random.default_rng(1)
    q = rng.normal(size=(2, 6, 2)) * 300
    q[:, 4] = np.nan
    return TrueDots(
        view=view,
        camera=camera,
        index=np.stack(np.divmod(np.arange(6), 3)[::-1], axis=-1),
        point=rng.normal(size=(6, 3)) / 3,
        centre=q[0],
        centroid=q[1],
        visible=np.array([True, True, False, True, False, True]),
    )


def truth(pair: dict[str, Camera]) -> Truth:
    return Truth(
        cameras={name: CameraRecord.of(camera) for name, camera in pair.items()},
        views={"one": TrueView(T_world_target=matrix4_record(np.eye(4) / 1.0))},
    )


def test_truth_reads_back_exactly(tmp_path: Path, pair: dict[str, Camera]) -> None:
    assert not has_truth(tmp_path)
    dots = [some_dots("one", "left"), some_dots("one", "right")]
    write_truth(tmp_path, truth(pair), dots)
    assert has_truth(tmp_path)
    assert read_truth(tmp_path) == truth(pair)
    for back, given in zip(read_true_dots(tmp_path), dots, strict=True):
        for field in fields(TrueDots):
            np.testing.assert_array_equal(getattr(back, field.name), getattr(given, field.name))


def test_the_files_have_the_form_that_others_rely_on(tmp_path: Path, pair: dict[str, Camera]) -> None:
    write_truth(tmp_path, truth(pair), [some_dots("one", "left")])
    lines = (tmp_path / "truth" / "dots.csv").read_text().splitlines()
    assert lines[0] == HEADER
    assert len(lines) == 7
    assert lines[5].split(",")[:4] == ["one", "left", "1", "1"]
    assert lines[5].split(",")[7:] == ["nan", "nan", "nan", "nan", "0"]
    assert lines[1].endswith(",1")
    content = json.loads((tmp_path / "truth" / "truth.json").read_text())
    assert {"cameras", "views"} <= set(content)
    assert set(content["cameras"]["left"]) == {"K", "lens", "dist", "T_cam_world", "size"}
    assert np.shape(content["views"]["one"]["T_world_target"]) == (4, 4)


def test_a_mistake_and_pictures_of_their_own_are_told(tmp_path: Path, pair: dict[str, Camera]) -> None:
    plain = truth(pair)
    own = TruePicture(taken_by="left", T_cam_world=matrix4_record(np.diag([-1.0, -1.0, 1.0, 1.0])))
    mistaken = plain.model_copy(
        update={
            "views": {"one": plain.views["one"].model_copy(update={"cameras": {"right": own}})},
            "mistake": "swapped-cameras",
            "mistake_description": "Exchanged.",
            "mistake_views": ("one",),
        }
    )
    write_truth(tmp_path, mistaken, [])
    assert read_truth(tmp_path) == mistaken
    content = json.loads((tmp_path / "truth" / "truth.json").read_text())
    assert content["mistake"] == "swapped-cameras"
    assert content["views"]["one"]["cameras"]["right"]["T_world_target"] is None
    # A shoot from before there were mistakes has none of these keys.
    for key in ("mistake", "mistake_description", "mistake_views"):
        del content[key]
    del content["views"]["one"]["cameras"]
    (tmp_path / "truth" / "truth.json").write_text(json.dumps(content))
    assert read_truth(tmp_path) == plain


def test_damage_is_refused(tmp_path: Path, pair: dict[str, Camera]) -> None:
    for read in (read_truth, read_true_dots):
        with pytest.raises(InputError, match="cannot be read"):
            read(tmp_path)
    write_truth(tmp_path, truth(pair), [some_dots("one", "left")])
    path = tmp_path / "truth" / "dots.csv"
    good = path.read_text()
    for damaged in (
        good.replace("one,left,1,1,", "one,left,1,", 1),
        good.replace("one,left,1,1,", "one,left,x,1,"),
        good.replace("one,left,1,1,", "one,left,1.5,1,"),
        good.replace("one,left,1,1,", "one,left,1,-1,"),
        good.replace("one,left,1,1,", "one,left,1e300,1,"),
        good.replace("one,left,1,1,", "o_ne,left,1,1,"),
    ):
        assert damaged != good
        path.write_text(damaged)
        with pytest.raises(InputError, match=r"Line 6 of .*dots\.csv is damaged \(.*\)"):
            read_true_dots(tmp_path)
    path.write_text(good.replace("one,left,1,1,", "one,left,0,1,"))
    with pytest.raises(InputError, match="is of the same dot of a picture as line"):
        read_true_dots(tmp_path)
    path.write_text(good.replace("visible", "shown"))
    with pytest.raises(InputError, match="its first line should be view,camera"):
        read_true_dots(tmp_path)
    path.write_text("")
    with pytest.raises(InputError, match="its first line should be view,camera"):
        read_true_dots(tmp_path)
    (tmp_path / "truth" / "truth.json").write_text("{}")
    with pytest.raises(InputError, match=r"The truth .* cannot be used: cameras: this key is missing"):
        read_truth(tmp_path)
