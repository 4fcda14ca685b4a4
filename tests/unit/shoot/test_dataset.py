"""shoot.json: keys, round trip, and damage."""

import json
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from labcal.cameras.record import matrix4_record
from labcal.errors import InputError
from labcal.shoot.dataset import open_shoot, write_manifest
from labcal.shoot.manifest import CameraEntry, Manifest, Role, ViewEntry
from labcal.targets.grid import DotGrid

POSE = np.array([[1.0, 0, 0, 650], [0, 1, 0, 1 / 3], [0, 0, 1, 200], [0, 0, 0, 1]])


@pytest.fixture
def manifest(grid: DotGrid) -> Manifest:
    def view(name: str, role: Role, pose: np.ndarray | None) -> ViewEntry:
        nominal = None if pose is None else matrix4_record(pose)
        images = {"left": f"images/{name}_left.png"}
        return ViewEntry(name=name, images=images, role=role, T_world_target_nominal=nominal)

    return Manifest(
        target=grid,
        cameras={"left": CameraEntry(size=(640, 480)), "right": CameraEntry(size=(800, 600))},
        views=(view("one", Role.TRAIN, POSE), view("two", Role.TEST, None)),
    )


def test_a_manifest_reads_back(tmp_path: Path, manifest: Manifest, grid: DotGrid) -> None:
    write_manifest(tmp_path, manifest)
    shoot = open_shoot(tmp_path)
    assert shoot.manifest == manifest
    assert shoot.target == grid
    assert shoot.cameras == ("left", "right")
    assert [view.name for view in shoot.views()] == ["one", "two"]
    assert [view.name for view in shoot.views(Role.TEST)] == ["two"]
    assert list(shoot.nominal_poses()) == ["one"]
    np.testing.assert_array_equal(shoot.nominal_poses()["one"], POSE)


def test_the_file_has_the_keys_that_others_rely_on(tmp_path: Path, manifest: Manifest) -> None:
    write_manifest(tmp_path, manifest)
    content = json.loads((tmp_path / "shoot.json").read_text())
    assert set(content) == {"format", "format_version", "target", "cameras", "views"}
    assert content["cameras"] == {"left": {"size": [640, 480]}, "right": {"size": [800, 600]}}
    assert set(content["views"][0]) == {"name", "images", "role", "T_world_target_nominal"}
    assert content["views"][0]["T_world_target_nominal"] == POSE.tolist()
    assert content["views"][1]["T_world_target_nominal"] is None
    assert [view["role"] for view in content["views"]] == ["train", "test"]
    assert content["target"]["rings"]["origin"] == [1, 0]


def changed(content: dict[str, Any], path: list[Any], value: object) -> dict[str, Any]:
    *parents, last = path
    node = content
    for step in parents:
        node = node[step]
    node[last] = value
    return content


@pytest.mark.parametrize(
    ("path", "value", "said"),
    [
        (["views"], [], "has no pictures. Render or capture it again"),
        (["views", 0, "images"], {}, "views.0.images"),
        (["views", 1, "name"], "one", "two views have the same name"),
        (["views", 1, "name"], "a_b", "views.1.name"),
        (["views", 1, "name"], "One", "the views 'one' and 'One' differ only in capital letters"),
        (["views", 1, "images"], {"middle": "images/x.png"}, "unknown cameras: middle"),
        (["views", 1, "images"], {"left": "../x.png"}, "views.1.images.left"),
        (["views", 1, "images"], {"left": "images/a.png", "right": "images/a.png"}, "two cameras or views"),
        (["views", 0, "T_world_target_nominal", 0, 0], 2.0, "rigid"),
        (["views", 0, "T_world_target_nominal", 0, 3], 1e30, "moves by more than"),
        (["cameras", "left", "size"], [2**31, 480], "at most 100000"),
        (["cameras", "left", "size"], [100_000, 100_000], "more than 400000000 pixels"),
        (["format_version"], 2, "format_version"),
        (["lens"], "brown5", "lens: this key is not known"),
        (["cameras", "left", "size"], [0, 480], "cameras.left.size.0"),
        (["target", "rings", "x"], [0, 0], "target.rings"),
    ],
)
def test_a_damaged_manifest_is_refused(
    tmp_path: Path, manifest: Manifest, path: list[Any], value: object, said: str
) -> None:
    content = changed(json.loads(manifest.model_dump_json()), path, value)
    (tmp_path / "shoot.json").write_text(json.dumps(content))
    with pytest.raises(InputError) as refusal:
        open_shoot(tmp_path)
    assert said in str(refusal.value)


def test_what_is_no_shoot_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"is not a shoot: it has no shoot\.json.*labcal render"):
        open_shoot(tmp_path)
    (tmp_path / "shoot.json").write_text('{"format":')
    with pytest.raises(InputError, match=r"The manifest .*shoot\.json is not valid JSON"):
        open_shoot(tmp_path)


def test_a_picture_given_twice_among_many_is_found_at_once(tmp_path: Path, manifest: Manifest) -> None:
    content = json.loads(manifest.model_dump_json())
    view = content["views"][0] | {"T_world_target_nominal": None}
    content["views"] = [
        view | {"name": f"v{n}", "images": {"left": f"images/{min(n, 29_998)}.png"}} for n in range(30_000)
    ]
    (tmp_path / "shoot.json").write_text(json.dumps(content))
    started = time.process_time()
    with pytest.raises(InputError, match=r"'images/29998\.png' is that of two cameras or views"):
        open_shoot(tmp_path)
    assert time.process_time() - started < 4.0  # comparing each with all took over ten
