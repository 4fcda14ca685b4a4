"""Scale and geometry, measured in the files without the code that drew them."""

import re
import struct
import xml.etree.ElementTree as ET
import zlib
from pathlib import Path

import cv2
import matplotlib as mpl
import numpy as np
import pytest

from labcal.errors import InputError, OutputError, UnknownNameError
from labcal.targets.artwork import ArtworkFormat, draw_artwork, export_artwork
from labcal.targets.catalogue import load_target
from labcal.targets.grid import DotGrid, Polarity

MM_PER_POINT = 25.4 / 72
SVG = "{http://www.w3.org/2000/svg}"


def numbers(text: str) -> np.ndarray:
    return np.array([float(word) for word in re.findall(r"-?\d+\.?\d*", text)]).reshape(-1, 2)


def boxes(outlines: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Return centre and size, in mm, of the boxes around outlines given in points, y up."""
    low = np.array([outline.min(axis=0) for outline in outlines])
    high = np.array([outline.max(axis=0) for outline in outlines])
    return (low + high) / 2 * MM_PER_POINT, (high - low) * MM_PER_POINT


def svg_outlines(content: bytes) -> list[np.ndarray]:
    group = ET.fromstring(content).find(f".//{SVG}g[@id='dots']")  # noqa: S314 - our own file
    assert group is not None
    path = group[0].attrib["d"]
    return [numbers(part) * [1, -1] for part in path.split("M")[1:]]


def pdf_outlines(content: bytes) -> list[np.ndarray]:
    streams = re.findall(rb"stream\n(.*?)\nendstream", content, re.DOTALL)
    for stream in streams:
        try:
            text = zlib.decompress(stream).decode("latin-1")
        except zlib.error:
            continue
        if " c\n" in text:
            return [numbers(part) for part in re.findall(r"[\d. -]+ m\n(?:[\d. -]+ c\n)+", text)]
    raise AssertionError("the PDF has no page with curves")


@pytest.mark.parametrize(
    "name", ["rings-10x8", "rings-14x10", "paper-13x10", "plain-11x8", "asymmetric-4x11"]
)
@pytest.mark.parametrize(("kind", "outlines"), [("svg", svg_outlines), ("pdf", pdf_outlines)])
def test_dots_and_rings_are_drawn_to_scale(kind: str, outlines, name: str) -> None:  # type: ignore[no-untyped-def]  # noqa: ANN001 - a function of this file
    target = load_target(name)
    centres, sizes = boxes(outlines(draw_artwork(target, ArtworkFormat(kind)).content))
    assert len(centres) == target.count + len(target.ring_indices)  # the holes of the rings come last
    places = target.points()[:, :2]
    assert centres[: target.count] - centres[0] == pytest.approx(places - places[0], abs=1e-4)
    assert sizes[: target.count] == pytest.approx(
        np.repeat(target.outer_diameters_mm()[:, None], 2, axis=1), abs=1e-4
    )
    rings = target.points(np.array(target.ring_indices, dtype=int).reshape(-1, 2))[:, :2]
    assert centres[target.count :] - centres[0] == pytest.approx(rings, abs=1e-4)
    holes = np.full((len(rings), 2), target.ring_inner_diameter_mm or 0.0)
    assert sizes[target.count :] == pytest.approx(holes, abs=1e-4)


def test_the_paper_says_its_size(grid: DotGrid) -> None:
    svg = draw_artwork(grid, ArtworkFormat.SVG)
    root = ET.fromstring(svg.content)  # noqa: S314 - our own file
    assert root.attrib["width"].endswith("pt")
    width, height = (float(root.attrib[key].removesuffix("pt")) for key in ("width", "height"))
    assert (width * MM_PER_POINT, height * MM_PER_POINT) == pytest.approx(
        (svg.width_mm, svg.height_mm), abs=1e-5
    )
    # One unit of the drawing is one point.
    assert [float(word) for word in root.attrib["viewBox"].split()] == pytest.approx([0, 0, width, height])
    pdf = draw_artwork(grid, ArtworkFormat.PDF)
    box = re.search(rb"/MediaBox \[ ([\d. ]+) \]", pdf.content)
    assert box is not None
    corners = np.array([float(word) for word in box[1].split()]) * MM_PER_POINT
    assert corners == pytest.approx([0, 0, pdf.width_mm, pdf.height_mm], abs=1e-5)


def test_the_ruler_in_the_drawing_is_100_mm_long(grid: DotGrid) -> None:
    root = ET.fromstring(draw_artwork(grid, ArtworkFormat.SVG).content)  # noqa: S314 - our own file
    group = root.find(f".//{SVG}g[@id='ruler']")
    assert group is not None
    ends = numbers(group[0].attrib["d"])
    assert (ends[1] - ends[0]) * MM_PER_POINT == pytest.approx([100.0, 0.0], abs=1e-4)


def decoded(content: bytes) -> tuple[np.ndarray, float]:
    """Return the grey values of a PNG from 0 to 1, and the pixels a millimetre that it claims."""
    picture = cv2.imdecode(np.frombuffer(content, np.uint8), cv2.IMREAD_GRAYSCALE)
    assert picture is not None
    at = content.index(b"pHYs") + 4
    across, down, unit = struct.unpack(">IIB", content[at : at + 9])
    assert (across, unit) == (down, 1)  # pixels a metre
    return picture / 255.0, across / 1000.0


def disc_centroids(ink: np.ndarray) -> np.ndarray:
    """Return the grey centroids of all round spots, in px, top down."""
    count, _, stats, _ = cv2.connectedComponentsWithStats((ink > 0.5).astype(np.uint8))
    centroids = []
    for left, top, width, height, area in stats[1:count]:
        # Rings fill 0.6 of their box and more, discs 0.79, letters and lines are small or sparse.
        if abs(int(width) - int(height)) > 1 or width < 40 or area < 0.5 * width * height:
            continue
        window = ink[top - 3 : top + height + 3, left - 3 : left + width + 3]
        rows, cols = np.mgrid[top - 3 : top + height + 3, left - 3 : left + width + 3]
        centroids.append([(window * cols).sum() / window.sum(), (window * rows).sum() / window.sum()])
    return np.array(centroids)


@pytest.mark.parametrize("polarity", Polarity)
@pytest.mark.parametrize("dpi", [254, 300])
def test_dots_in_a_picture_are_at_their_places(dpi: int, polarity: Polarity, grid: DotGrid) -> None:
    target = grid.model_copy(update={"polarity": polarity})
    artwork = draw_artwork(target, ArtworkFormat.PNG, dpi=dpi)
    picture, pixels_per_mm = decoded(artwork.content)
    stated = np.array([artwork.height_mm, artwork.width_mm]) * dpi / 25.4
    assert stated == pytest.approx(picture.shape, abs=1e-6)  # whole pixels
    assert pixels_per_mm == pytest.approx(dpi / 25.4, rel=1e-4)
    white = polarity is Polarity.WHITE_ON_BLACK
    board = picture[: int(65 * pixels_per_mm)]  # without the ruler and the captions
    found = disc_centroids(board if white else 1 - board)
    assert len(found) == target.count
    seen = found * [1, -1] * 25.4 / dpi
    # Row by row from the lower left, as the target numbers its dots.
    order = np.lexsort((seen[:, 0], np.round(seen[:, 1])))
    places = target.points()[:, :2]
    off = seen[order] - places
    assert np.abs(off - off.mean(axis=0)).max() < 0.01


@pytest.mark.parametrize("dpi", [254, 300])
def test_the_ruler_in_a_picture_is_100_mm_long(dpi: int, grid: DotGrid) -> None:
    ink = 1 - decoded(draw_artwork(grid, ArtworkFormat.PNG, dpi=dpi, copy=None).content)[0]
    per_mm = dpi / 25.4
    # The only dark run of some 100 mm is the ruler's line; its longest marks are 4 mm, the next 3 mm.
    line = int(np.argmax((ink > 0.3).sum(axis=1) > 99 * per_mm))
    band = ink[line + round(3.2 * per_mm) : line + round(3.8 * per_mm)].mean(axis=0)
    edges = np.flatnonzero(np.diff(np.concatenate([[0], band > 0.02, [0]]).astype(int)))
    starts, ends = edges[::2], edges[1::2]
    marks = [
        np.average(np.arange(a, b), weights=band[a:b]) / per_mm for a, b in zip(starts, ends, strict=True)
    ]
    assert len(marks) == 11
    assert np.diff(marks) == pytest.approx(10.0, abs=0.05)
    assert marks[-1] - marks[0] == pytest.approx(100.0, abs=0.05)


def test_a_white_ring_has_a_black_hole(grid: DotGrid) -> None:
    target = grid.model_copy(update={"polarity": Polarity.WHITE_ON_BLACK})
    picture, _ = decoded(draw_artwork(target, ArtworkFormat.PNG, dpi=254).content)
    # The largest black thing is the board; its lower left corner lies 10 mm, 100 px, from the dot (0, 0).
    _, _, stats, _ = cv2.connectedComponentsWithStats((picture < 0.5).astype(np.uint8))
    left, top, _, height, _ = stats[1:][np.argmax(stats[1:, cv2.CC_STAT_AREA])]
    x0, y0 = left + 100, top + height - 100

    def grey(x_mm: float, y_mm: float) -> float:
        return float(picture[round(y0 - 10 * y_mm), round(x0 + 10 * x_mm)])

    assert grey(0.0, 0.0) == 1.0  # a dot
    assert grey(20.0, 0.0) == 0.0  # the hole of the origin ring, 3 mm wide
    assert grey(20.0 + 2.75, 0.0) == 1.0  # its annulus, from 1.5 mm to 4 mm
    assert grey(20.0, 25.0) == 0.0  # the hole of the y ring
    assert grey(10.0, 6.25) == 0.0  # the ground


@pytest.mark.parametrize("kind", ArtworkFormat)
def test_the_same_target_gives_the_same_bytes(kind: ArtworkFormat, grid: DotGrid) -> None:
    first = draw_artwork(grid, kind).content
    assert draw_artwork(grid, kind).content == first
    assert b"Date" not in first


def test_settings_of_the_user_change_nothing_and_stay_as_they_are(grid: DotGrid) -> None:
    expected = draw_artwork(grid, ArtworkFormat.SVG).content
    with mpl.rc_context({"savefig.bbox": "tight", "savefig.pad_inches": 1.0, "font.size": 30.0}):
        assert draw_artwork(grid, ArtworkFormat.SVG).content == expected
        assert mpl.rcParams["savefig.bbox"] == "tight"


def test_export_refuses_what_it_cannot_do(tmp_path: Path, grid: DotGrid) -> None:
    with pytest.raises(UnknownNameError, match="'png'"):
        export_artwork(grid, tmp_path / "x.jpg")
    with pytest.raises(InputError, match="no pixels"):
        export_artwork(grid, tmp_path / "x.svg", dpi=300)
    with pytest.raises(InputError, match="at least 1"):
        export_artwork(grid, tmp_path / "x.png", dpi=0)
    with pytest.raises(InputError, match=r"Give at most `dpi=\d+`"):
        export_artwork(grid, tmp_path / "x.png", dpi=100_000)
    with pytest.raises(OutputError, match="nowhere"):
        export_artwork(grid, tmp_path / "nowhere" / "x.svg")
    assert list(tmp_path.iterdir()) == []


def test_what_a_notebook_shows_of_a_drawing_is_short() -> None:
    drawn = draw_artwork(load_target("rings-10x8"), ArtworkFormat.SVG)
    assert repr(drawn) == f"Artwork(width_mm={drawn.width_mm}, height_mm={drawn.height_mm}, dpi=None)"
