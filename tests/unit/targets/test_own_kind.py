"""A kind of target from outside: a plain chessboard, registered without touching a file of the package."""

import json
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import cv2
import numpy as np
import pytest
from matplotlib.path import Path as Outline
from pydantic import BaseModel, ConfigDict

from labcal.arrays import DotIndices, Lengths, Vectors3
from labcal.calibrate.handheld import calibrate_handheld
from labcal.cameras.camera import Camera
from labcal.cameras.rig import Rig
from labcal.cameras.rig_file import read_rig
from labcal.cli import main
from labcal.correspond.detections import Detections
from labcal.detect.detector import detect_dots
from labcal.detect.dots import PictureDots
from labcal.detect.flags import DotFlag, Refusal
from labcal.detect.settings import DetectSettings
from labcal.errors import InputError, InputTypeError, UnknownNameError
from labcal.shoot.manifest import Manifest
from labcal.targets import registry
from labcal.targets.artwork import export_artwork
from labcal.targets.catalogue import load_target
from labcal.targets.grid import Polarity
from labcal.targets.places import DotPlaces
from labcal.targets.registry import TargetKind, register_target

See = Callable[..., Detections]
DESCRIPTION = "kind: own-chessboard\nname: chess-7x5\ncols: 7\nrows: 5\nsquare_mm: 12.0\n"


class Chessboard(BaseModel):
    """The inner corners of a chessboard, whose lower left square is black."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    kind: Literal["own-chessboard"]
    name: str
    description: str = ""
    cols: int
    rows: int
    square_mm: float
    margin_mm: float = 12.0
    least_margin_mm: float = 0.0
    place_name: str = "corner"
    is_white_on_black: bool = False

    @property
    def count(self) -> int:
        return self.cols * self.rows

    @property
    def extent_mm(self) -> tuple[float, float, float, float]:
        rim = self.square_mm + self.margin_mm
        return (-rim, -rim, (self.cols - 1) * self.square_mm + rim, (self.rows - 1) * self.square_mm + rim)

    @property
    def captions(self) -> tuple[str, str]:
        return f"{self.name}: {self.cols} x {self.rows} corners", f"squares {self.square_mm:g} mm"

    @property
    def sizes(self) -> tuple[str, str]:
        return f"{self.square_mm:g} x {self.square_mm:g}", "corner"

    def indices(self) -> DotIndices:
        row, col = np.divmod(np.arange(self.count), self.cols)
        return np.stack([col, row], axis=-1)

    def points(self, indices: DotIndices | None = None) -> Vectors3:
        wanted = self.indices() if indices is None else indices
        return np.concatenate([wanted * self.square_mm, np.zeros((len(wanted), 1))], axis=-1)

    def outer_diameters_mm(self) -> Lengths:
        return np.zeros(self.count)

    def symmetric_indices(self, indices: DotIndices) -> tuple[DotIndices, ...]:
        return (np.array([self.cols - 1, self.rows - 1]) - indices,)


def outlines(board: Chessboard) -> Outline:
    """Return the black squares."""
    squares = [
        np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]]) + np.array([i - 1, j - 1])
        for i in range(board.cols + 1)
        for j in range(board.rows + 1)
        if (i + j) % 2 == 0
    ]
    codes = [Outline.MOVETO, Outline.LINETO, Outline.LINETO, Outline.LINETO, Outline.CLOSEPOLY]
    return Outline(board.square_mm * np.concatenate(squares), codes * len(squares))


def detect(grey: np.ndarray, board: Chessboard, _settings: DetectSettings) -> PictureDots:
    """Return the corners that OpenCV finds, numbered from the lower left."""
    scaled = np.clip(255.0 * grey / max(float(grey.max()), 1e-9), 0, 255).astype(np.uint8)
    found, corners = cv2.findChessboardCornersSB(scaled, (board.cols, board.rows))
    q = np.asarray(corners, dtype=np.float64).reshape(-1, 2) if found else np.zeros((0, 2))
    if len(q) and q[0, 0] > q[board.cols - 1, 0]:  # turned by 180 degrees it looks the same
        q = q[::-1]
    if len(q) and q[0, 1] < q[-1, 1]:  # OpenCV counts from the upper left
        q = q.reshape(board.rows, board.cols, 2)[::-1].reshape(-1, 2)
    n = len(q)
    return PictureDots(
        size=(grey.shape[1], grey.shape[0]), polarity=Polarity.BLACK_ON_WHITE,
        refusal=None if found else Refusal.NO_GRID, index=board.indices()[:n], has_id=np.ones(n, dtype=bool),
        position=q, covariance=np.tile(0.0025 * np.eye(2), (n, 1, 1)), misfit=np.full(n, np.nan),
        flag=(DotFlag.OK,) * n, seen_at=q, outline=np.full((n, 2, 2), np.nan),
        others=(board.symmetric_indices(board.indices())[0],) if found else (),
    )  # fmt: skip


CHESSBOARD = TargetKind("own-chessboard", Chessboard, detect, outlines)


@pytest.fixture
def board(tmp_path: Path) -> Iterator[Chessboard]:
    """A chessboard read from a file, its kind registered for the length of a test."""
    register_target(CHESSBOARD)
    path = tmp_path / "chess.yaml"
    path.write_text(DESCRIPTION)
    try:
        yield load_target(str(path))
    finally:
        del registry._KINDS["own-chessboard"]


def picture(board: Chessboard, tmp_path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Return the print as a tilted camera sees it, and where its corners are."""
    path = tmp_path / "board.png"
    artwork = export_artwork(board, path, dpi=150)
    paper = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE)
    assert paper is not None
    px_per_mm = 150 / 25.4
    assert paper.shape[1] == pytest.approx(artwork.width_mm * px_per_mm, abs=1.0)
    middle = 0.5 * (board.extent_mm[0] + board.extent_mm[2])
    left = middle - 0.5 * artwork.width_mm
    top = board.extent_mm[3] + 10.0  # the border of a sheet
    on_paper = (board.points()[:, :2] - [left, top]) * [px_per_mm, -px_per_mm] - 0.5
    H = np.array([[0.9, 0.12, 20.0], [-0.08, 0.85, 90.0], [5e-5, 1e-4, 1.0]])
    seen = cv2.perspectiveTransform(on_paper[:, None], H)[:, 0]
    size = (int(seen[:, 0].max()) + 220, int(seen[:, 1].max()) + 220)
    return cv2.warpPerspective(paper, H, size, flags=cv2.INTER_AREA, borderValue=255), seen


def test_it_is_read_printed_and_detected(board: Chessboard, tmp_path: Path) -> None:
    assert isinstance(board, Chessboard)
    image, expected = picture(board, tmp_path)
    dots = detect_dots(image, board)
    assert dots.indexed
    np.testing.assert_array_equal(dots.index, board.indices())
    np.testing.assert_allclose(dots.position, expected, rtol=0, atol=0.6)  # at 150 dpi the print has steps


K = np.array([[900.0, 0.0, 318.0], [0.0, 905.0, 243.0], [0.0, 0.0, 1.0]])
SIZE = (640, 480)


def held(board: Chessboard, count: int) -> dict[str, np.ndarray]:
    """Return poses of the board 240 mm in front of a camera, tilted by half a radian every way."""
    found, middle = {}, board.points().mean(axis=0)
    for number in range(count):
        azimuth = 2.0 * np.pi * number / count
        T = np.eye(4)
        tilt, _ = cv2.Rodrigues(np.array([0.5 * np.cos(azimuth), 0.5 * np.sin(azimuth), 0.05 * number]))
        T[:3, :3] = np.diag([1.0, -1.0, -1.0]) @ tilt
        T[:3, 3] = [3.0 * number - 8.0, 4.0 - 2.0 * number, 240.0 + 5.0 * number] - T[:3, :3] @ middle
        found[f"pose-{number}"] = T
    return found


def require_focal_lengths(found: Rig, sigma: np.ndarray) -> None:
    """Raise unless the focal lengths are within three standard deviations, px, of the true ones."""
    fx, fy = found.camera("camera").intrinsics[:2]
    assert (np.abs([fx - K[0, 0], fy - K[1, 1]]) < 3.0 * sigma).all()
    assert (sigma < 3.0).all()


def test_it_is_calibrated_from_its_corners(see: See, board: Chessboard) -> None:
    camera = Camera(K, "pinhole", np.zeros(5), np.eye(4), SIZE)
    exact = see({"camera": camera}, board, held(board, 7))
    noise = 0.1 * np.random.default_rng(6).standard_normal(exact.position.shape)
    found = calibrate_handheld(replace(exact, position=exact.position + noise), board, "pinhole")
    fit = found.fits["camera"]
    require_focal_lengths(found.rig, fit.sigma.intrinsics[:2])
    assert fit.rms_px == pytest.approx(0.1 * np.sqrt(2.0), rel=0.15)


def test_the_commands_carry_it_from_the_print_to_the_camera(
    board: Chessboard, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def told(*words: object) -> dict[str, Any]:
        assert main([*map(str, words), "--json"]) == 0
        document: dict[str, Any] = json.loads(capsys.readouterr().out)
        return document

    description, paper = tmp_path / "chess.yaml", tmp_path / "chess.png"
    assert "own-chessboard" in told("target", "list")["kinds"]
    size = told("target", "export", description, "-o", paper, "--dpi", 200)
    print_ = cv2.imread(str(paper), cv2.IMREAD_GRAYSCALE)
    assert print_ is not None
    # From pixels of the print to millimetres of the board, as the ruler's neighbour in `picture` has it.
    mm = 25.4 / 200
    left = 0.5 * (board.extent_mm[0] + board.extent_mm[2]) - 0.5 * size["width_mm"]
    top = board.extent_mm[3] + 10.0
    to_board = np.array([[mm, 0.0, left + 0.5 * mm], [0.0, -mm, top - 0.5 * mm], [0.0, 0.0, 1.0]])
    pictures = tmp_path / "pictures"
    pictures.mkdir()
    for view, T in held(board, 7).items():
        H = K @ T[:3, [0, 1, 3]] @ to_board
        seen = cv2.warpPerspective(print_, H, SIZE, flags=cv2.INTER_AREA, borderValue=255)
        cv2.imwrite(str(pictures / f"{view}.png"), cv2.GaussianBlur(seen, (0, 0), 0.8))
    dots, rig = tmp_path / "dots.csv", tmp_path / "rig.json"
    found = told("detect", pictures, "--target", description, "-o", dots, "--workers", 1)
    assert found["indexed"] == 7
    fit = told("calibrate", dots, "--target", description, "--lens", "pinhole", "-o", rig)
    assert fit["rms_px"] < 0.3
    sigma = fit["cameras"]["camera"]["sigma"]
    require_focal_lengths(read_rig(rig), np.array([sigma["fx"], sigma["fy"]]))


def test_shoots_and_places_hold_it(board: Chessboard) -> None:
    manifest = Manifest.model_validate(
        {"target": board, "cameras": {"left": {"size": [640, 480]}}, "views": []}
    )
    text = manifest.model_dump_json()
    assert '"kind":"own-chessboard"' in text
    assert Manifest.model_validate_json(text) == manifest
    freed = np.zeros(board.count, dtype=bool)
    places = DotPlaces.of(board, board.points(), np.zeros((board.count, 3, 3)), freed.astype(int), freed)
    assert DotPlaces.model_validate_json(places.model_dump_json()) == places


def test_what_its_file_says_wrongly_is_told(board: Chessboard, tmp_path: Path) -> None:  # noqa: ARG001
    path = tmp_path / "wrong.yaml"
    path.write_text(DESCRIPTION.replace("square_mm", "sqare_mm"))
    with pytest.raises(InputError, match=r"sqare_mm: this key is not known; the nearest one is 'square_mm'"):
        load_target(str(path))
    path.write_text(DESCRIPTION.replace("chessboard", "chesboard"))
    with pytest.raises(UnknownNameError, match=r"named 'own-chesboard'. Did you mean 'own-chessboard'"):
        load_target(str(path))
    path.write_text(DESCRIPTION.replace("kind: own-chessboard", "kind: dots"))
    expected = (
        r"'dots' should be one of charuco, coded-dots, chessboard, aprilgrid, boards, own-chessboard, or left"
    )
    with pytest.raises(InputError, match=expected):
        load_target(str(path))


def test_what_is_no_kind_is_refused() -> None:
    class Bare(BaseModel):
        name: str

    class Nameless(Chessboard):
        pass

    with pytest.raises(InputTypeError, match=r"it lacks .*extent_mm"):
        register_target(TargetKind("bare", Bare, detect, outlines))
    with pytest.raises(InputError, match="'charuco' is a name of labcal's already"):
        register_target(TargetKind("charuco", Nameless, detect, outlines))
    with pytest.raises(InputError, match="letters, digits and hyphens"):
        register_target(TargetKind("a b", Nameless, detect, outlines))
    with pytest.raises(InputError, match="names no function"):
        registry.run_part(replace(CHESSBOARD, detector="nowhere"), "detector")
    stray = Chessboard(kind="own-chessboard", name="a", cols=4, rows=3, square_mm=5.0)
    with pytest.raises(InputTypeError, match="Register its kind"):
        detect_dots(np.zeros((50, 50)), stray)
