"""Who took which picture, by every naming, from the files to the calibrated pair."""

import json
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest

import labcal.pipeline
from labcal.cameras.rig_file import read_rig
from labcal.cli import main
from labcal.correspond.picture_set import PictureSet, open_pictures
from labcal.errors import InputError
from labcal.shoot.raw_pictures import parse_raw_format
from labcal.targets.grid import DotGrid, Rings

K = np.array([[560.0, 0.0, 251.0], [0.0, 560.0, 186.0], [0.0, 0.0, 1.0]])
SIZE, VIEWS, FINER = (500, 375), 8, 4
BASELINE_MM, TURNED = 60.0, 0.12
TARGET = DotGrid(
    name="held", cols=9, rows=7, pitch_x_mm=20, pitch_y_mm=20, dot_diameter_mm=8, ring_outer_diameter_mm=12,
    ring_inner_diameter_mm=5, rings=Rings(origin=(2, 2), x=(6, 2), y=(2, 5)), margin_mm=15,
)  # fmt: skip
CAMERAS = ("left", "right")
NAMES: dict[str, Callable[[str, int], str]] = {
    "endings": lambda camera, view: f"shot{view}_{'01'[CAMERAS.index(camera)]}.png",
    "folders": lambda camera, view: f"{camera.upper()}/{view:02d}.png",
    "prefixes": lambda camera, view: f"{camera}{view:02d}.png",
    "infix": lambda camera, view: f"shot_{view:02d}_cam{'AB'[CAMERAS.index(camera)]}_x.png",
    "hyphen": lambda camera, view: f"{view:02d}-{camera[0]}.png",
    "named parts": lambda camera, view: f"run/cam_{camera}/{view:02d}.png",
    "lists": lambda camera, view: f"{'ab'[CAMERAS.index(camera)]}/IMG{view * (3 + len(camera)):04d}.png",
    "unlike folders": lambda camera, view: f"{camera}/IMG{view * 3 + 100 * len(camera):04d}.png",
}
OPTIONS = {
    "endings": "_0=left,_1=right",
    "folders": "LEFT/*=left,RIGHT/*=right",
    "prefixes": "left*=left,right*=right",
    "infix": "*_camA_*=left,*_camB_*=right",
    "hyphen": "-l=left,-r=right",
    "named parts": "cam_{camera}/{view}",
    "lists": "left=photos/left.txt,right=photos/right.txt",
    "unlike folders": "left=photos/left/,right=photos/right/",
}


def _drawn(camera: int, view: int) -> np.ndarray:
    """Return a view of the target: outlines of dots, projected and filled."""
    random = np.random.default_rng(view)
    away = cv2.Rodrigues(random.normal(0.0, 0.3, 3))[0] @ np.diag([1.0, -1.0, -1.0])
    middle = TARGET.points().mean(axis=0)
    place = np.array([20.0, 0.0, 330.0]) + random.uniform(-25.0, 25.0, 3) - away @ middle
    turned = cv2.Rodrigues(np.array([0.0, TURNED * camera, 0.0]))[0]
    R, t = turned @ away, turned @ (place - [BASELINE_MM * camera, 0.0, 0.0])
    canvas = np.full((SIZE[1] * FINER, SIZE[0] * FINER), 215, dtype=np.uint8)
    angle = np.linspace(0.0, 2.0 * np.pi, 64, endpoint=False)
    circle = np.stack([np.cos(angle), np.sin(angle), 0.0 * angle], axis=-1)

    def fill(at: np.ndarray, radius: float, grey: int) -> None:
        q = (at + radius * circle) @ R.T + t
        q = (q @ K.T)[:, :2] / q[:, 2:]
        cv2.fillPoly(
            canvas, [np.round(((q + 0.5) * FINER - 0.5) * 16).astype(np.int32)], grey, cv2.LINE_AA, 4
        )

    rings = {TARGET.rings.origin, TARGET.rings.x, TARGET.rings.y} if TARGET.rings is not None else set()
    for index, point in zip(TARGET.indices().tolist(), TARGET.points(), strict=True):
        ring = tuple(index) in rings
        fill(point, 6.0 if ring else 4.0, 40)
        if ring:
            fill(point, 2.5, 215)
    light = cv2.GaussianBlur(cv2.resize(canvas, SIZE, interpolation=cv2.INTER_AREA), (0, 0), 0.7)
    return np.clip(light + random.normal(0.0, 1.0, light.shape), 0, 255).round().astype(np.uint8)


@pytest.fixture(scope="module")
def pictures() -> dict[tuple[str, int], np.ndarray]:
    return {
        (name, view): _drawn(camera, view) for camera, name in enumerate(CAMERAS) for view in range(VIEWS)
    }


def _laid_out(home: Path, naming: str, pictures: dict[tuple[str, int], np.ndarray]) -> Path:
    """Write pictures by a naming; lists beside them."""
    folder = home / "photos"
    for (camera, view), picture in pictures.items():
        path = folder / NAMES[naming](camera, view)
        path.parent.mkdir(parents=True, exist_ok=True)
        cv2.imwrite(str(path), picture)
    if naming == "lists":
        for camera in CAMERAS:
            lines = [NAMES[naming](camera, view) for view in range(VIEWS)]
            (folder / f"{camera}.txt").write_text("# views\n" + "\n".join(lines) + "\n", encoding="utf-8")
    (home / "held.yaml").write_text(json.dumps(TARGET.model_dump(mode="json")), encoding="utf-8")
    return folder


_QUICK = ("lists", "named parts")
"""One that the names give, and one that they do not; what all namings give is compared below, too."""


@pytest.mark.parametrize(
    "naming", [one if one in _QUICK else pytest.param(one, marks=pytest.mark.slow) for one in OPTIONS]
)
def test_a_pair_is_calibrated_by_every_naming(
    naming: str,
    pictures: dict[tuple[str, int], np.ndarray],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    _laid_out(tmp_path, naming, pictures)
    monkeypatch.chdir(tmp_path)
    found = ["--target", "held.yaml", "-o", "dots.csv", "--workers", "1"]
    assert main(["detect", "photos", "--cameras", OPTIONS[naming], *found]) == 0
    lens = ["--target", "held.yaml", "--lens", "brown-k1k2", "-o", "rig.json"]
    assert main(["calibrate", "dots.csv", *lens]) == 0
    rig = read_rig(tmp_path / "rig.json")
    assert list(rig.cameras) == ["left", "right"]
    for name in CAMERAS:
        assert rig.camera(name).K[0, 0] == pytest.approx(560.0, abs=2.0)
    T = rig.camera("right").T_cam_world
    assert np.linalg.norm(T[:3, 3]) == pytest.approx(BASELINE_MM, abs=0.3)


COMMANDS = {
    "detect": "detect photos --target held.yaml -o out.csv",
    "inspect": "inspect photos --target held.yaml -o out.html",
    "check": "check rig.json photos --target held.yaml",
    "check of marks": "check rig.json photos --places places.csv --markers coded-8x6",
    "diagnose": "diagnose photos --target held.yaml",
    "undistort": "undistort rig.json photos -o out",
    "twin": "twin photos rig.json --target held.yaml -o out",
    "measure": "measure rig.json photos --markers coded-8x6 -o out.csv",
}


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("naming", OPTIONS)
def test_every_command_takes_the_same_namings_and_forms(
    command: str, naming: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    blank = np.zeros((4, 6), dtype=np.uint8)
    _laid_out(tmp_path, naming, {(camera, view): blank for camera in CAMERAS for view in range(VIEWS)})
    (tmp_path / "rig.json").write_text("{}", encoding="utf-8")
    (tmp_path / "places.csv").write_text("", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    opened: list[PictureSet] = []

    def spy(*given: object) -> None:
        opened.append(open_pictures(*given))  # type: ignore[arg-type]
        raise InputError("Pictures were opened: the rest does not matter here.")

    monkeypatch.setattr(labcal.pipeline, "open_pictures", spy)
    words = [*COMMANDS[command].split(), "--cameras", OPTIONS[naming], "--raw", "BayerGB8"]
    assert main(words) == 2
    by_view: dict[str, list[str]] = {}
    for source in opened[0].sources:
        by_view.setdefault(source.view, []).append(source.camera)
    assert list(by_view.values()) == [["left", "right"]] * VIEWS
    assert {source.raw for source in opened[0].sources} == {parse_raw_format("BayerGB8")}
    for number, source in enumerate(sorted(opened[0].sources, key=lambda one: (one.camera, one.view))):
        camera, view = CAMERAS[number // VIEWS], number % VIEWS
        assert Path(source.image) == Path("photos") / NAMES[naming](camera, view)


def test_lists_that_do_not_pair_up_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("a/1.png", "a/2.png", "b/1.png", "b/2.png", "b/3.png", "c/4.png", "c/5.png"):
        Path(name).parent.mkdir(exist_ok=True)
        Path(name).write_bytes(b"x")

    def opened(cameras: str, left: str = "", right: str = "", given: str = ".") -> PictureSet:
        Path("left.txt").write_text(left.replace(" ", "\n"), encoding="utf-8")
        Path("right.txt").write_text(right.replace(" ", "\n"), encoding="utf-8")
        return open_pictures(given.split(), cameras)

    both = "left=left.txt,right=right.txt"
    with pytest.raises(InputError, match=r"left\.txt has 2, right\.txt has 1"):
        opened(both, "a/1.png a/2.png", "b/1.png")
    with pytest.raises(InputError, match=r"a/ has 2, b/ has 3"):
        opened("left=a/,right=b/")
    with pytest.raises(InputError, match=r"Line 2 of right\.txt names b/9\.png, but no such file"):
        opened(both, "a/1.png a/2.png", "b/1.png b/9.png")
    with pytest.raises(InputError, match=r"twice in left\.txt and right\.txt"):
        opened(both, "a/1.png", "a/1.png")
    with pytest.raises(InputError, match="not in the same order"):
        opened(both, "a/1.png a/2.png", "b/2.png b/1.png")
    with pytest.raises(InputError, match=r"left\.txt lists no pictures"):
        opened(both, "", "b/1.png")
    with pytest.raises(InputError, match=r"none\.txt, but no such list or folder"):
        opened("left=none.txt,right=a/")
    with pytest.raises(InputError, match="With lists"):
        opened("left=left.txt,_1=right", "a/1.png")
    with pytest.raises(InputError, match=r"b/1\.png, which is not among the pictures given"):
        opened(both, "a/1.png", "b/1.png", "a")
    # One name in both is one view; else the order is what pairs.
    found = opened(both, "a/1.png a/2.png", "b/1.png b/2.png", "left.txt right.txt")
    assert [(one.view, one.camera) for one in found.sources][:2] == [("1", "left"), ("1", "right")]
    assert found.endings == both
    found = opened("left=a/,right=c/")
    assert [(one.view, one.camera, one.image) for one in found.sources] == [
        ("0001", "left", "a/1.png"),
        ("0001", "right", "c/4.png"),
        ("0002", "left", "a/2.png"),
        ("0002", "right", "c/5.png"),
    ]
    assert found.warnings == ("3 pictures in none of the lists left out: b/1.png, b/2.png, b/3.png.",)
