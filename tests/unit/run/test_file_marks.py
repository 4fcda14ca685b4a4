"""Marks in files: they tell labcal's from others', and no reader of the format minds them."""

import io
import json
import re
import tomllib
import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
import scipy.io
import yaml
from PIL import Image

from labcal.bench.detect.bias import bench_camera
from labcal.cameras.interop.registry import FORMATS
from labcal.cameras.rig import Rig
from labcal.run.file_marks import (
    JPEG_COMMENT,
    JSON_KEY,
    PDF_COMMENT,
    PNG_TEXT,
    TEXT_COMMENT,
    TRAILER,
    VNL_COMMENT,
    XML_COMMENT,
    FileMark,
    FormatMark,
    Judgement,
)
from labcal.targets.artwork import ArtworkFormat, draw_artwork
from labcal.targets.grid import DotGrid

PICTURE = np.random.default_rng(3).integers(0, 256, (30, 41, 3), dtype=np.uint8)


def encoded(ending: str, picture: np.ndarray = PICTURE) -> bytes:
    return cv2.imencode(ending, picture)[1].tobytes()


MARKED: dict[str, tuple[FileMark, bytes]] = {
    "PNG": (PNG_TEXT, encoded(".png")),
    "JPEG": (JPEG_COMMENT, encoded(".jpg")),
    "JPEG without JFIF": (JPEG_COMMENT, b"\xff\xd8\xff\xdb\0\x04ab"),
    "TIFF": (TRAILER, encoded(".tif")),
    "BMP": (TRAILER, encoded(".bmp")),
    "PDF": (PDF_COMMENT, b"%PDF-1.4\n1 0 obj\nendobj\nxref\ntrailer\n<< >>\nstartxref\n23\n%%EOF\n"),
    "SVG": (XML_COMMENT, b'<?xml version="1.0" encoding="utf-8"?>\n<svg/>\n'),
    "XML": (TEXT_COMMENT, b"<list>\n</list>\n"),
    "YAML": (TEXT_COMMENT, b"cam0: 1\n"),
    "FileStorage": (TEXT_COMMENT, b"%YAML:1.0\n---\nT: 1\n"),
    "a text with comments": (TEXT_COMMENT, b"# camera: left\n{}\n"),
    "corners.vnl": (VNL_COMMENT, b"# filename x y weight\n"),
    "JSON": (JSON_KEY, b'{\n  "seconds": 1\n}\n'),
}


@pytest.mark.parametrize("name", MARKED)
def test_only_what_is_as_labcal_wrote_it_counts_as_its_own(name: str) -> None:
    mark, content = MARKED[name]
    marked = mark.put(content)
    assert mark.put(content) == marked  # the same bytes each time
    assert mark.judge(content) is Judgement.UNMARKED
    assert mark.judge(b"") is Judgement.UNMARKED
    assert mark.judge(marked) is Judgement.AS_WRITTEN
    found = re.search(rb"Made by labcal; SHA-256 of all else in this file: ([0-9a-f]{64})", marked)
    assert found is not None
    for at in (0, found.start(), found.start(1), found.end(), len(marked) - 1):
        for changed in (marked[:at] + b"?" + marked[at:], marked[:at] + b"?" + marked[at + 1 :]):
            assert mark.judge(changed) is not Judgement.AS_WRITTEN, at
    assert mark.judge(marked + b"\n") is Judgement.CHANGED
    assert mark.judge(content + marked[found.start() : found.end()]) is Judgement.CHANGED  # moved elsewhere


@pytest.mark.parametrize("ending", [".png", ".jpg", ".tif", ".bmp"])
@pytest.mark.parametrize("picture", [PICTURE, PICTURE[..., 0]])
def test_marked_pictures_are_read_by_others(ending: str, picture: np.ndarray) -> None:
    marks = {".png": PNG_TEXT, ".jpg": JPEG_COMMENT, ".tif": TRAILER, ".bmp": TRAILER}
    content = encoded(ending, picture)
    marked = marks[ending].put(content)
    plain = cv2.imdecode(np.frombuffer(content, np.uint8), cv2.IMREAD_UNCHANGED)
    np.testing.assert_array_equal(cv2.imdecode(np.frombuffer(marked, np.uint8), cv2.IMREAD_UNCHANGED), plain)
    with Image.open(io.BytesIO(content)) as first, Image.open(io.BytesIO(marked)) as second:
        np.testing.assert_array_equal(np.asarray(first), np.asarray(second))
        told = str(second.info.get("Software", second.info.get("comment", "")))
    assert ("Made by labcal" in told) == (ending in {".png", ".jpg"})


def test_marked_drawings_are_drawings(grid: DotGrid) -> None:
    svg, pdf = (draw_artwork(grid, kind).content for kind in (ArtworkFormat.SVG, ArtworkFormat.PDF))
    first, second = (ET.tostring(ET.fromstring(one)) for one in (svg, XML_COMMENT.put(svg)))  # noqa: S314
    assert first == second
    marked = PDF_COMMENT.put(pdf)
    at = int(re.findall(rb"startxref\n(\d+)\n%%EOF", marked)[-1])
    assert marked[at:].startswith(b"xref")  # nothing that the table points to has moved
    assert marked[: pdf.rindex(b"startxref")] == pdf[: pdf.rindex(b"startxref")]


@pytest.mark.parametrize(
    "name", [name for name in FORMATS if name not in {"labcal", "colmap", "colmap-binary"}]
)
@pytest.mark.parametrize("count", [1, 2])
def test_marked_cameras_are_read_by_others_and_come_back(name: str, count: int, tmp_path: Path) -> None:
    one = FORMATS[name]
    if name == "matchid" and count == 1:
        return  # it holds pairs only
    first = bench_camera()
    T = first.T_cam_world.copy()
    T[0, 3] -= 100.0
    rig = Rig.of(dict(zip(("left", "right")[:count], (first, replace(first, T_cam_world=T)), strict=False)))
    for suffix in one.suffixes:
        for text in (file.text for file in one.write(rig, suffix).files):
            content = text if isinstance(text, bytes) else text.encode()
            marked = one.mark.put(content)
            assert one.mark.judge(marked) is Judgement.AS_WRITTEN
            assert one.recognises(marked.decode("latin-1"))
            told, meant = (read(name, suffix, file, tmp_path) for file in (marked, content))
            for one_told, one_meant in zip(told, meant, strict=True):
                np.testing.assert_array_equal(one_told, one_meant)


def read(name: str, suffix: str, content: bytes, folder: Path) -> list[object]:
    """Return what another program has of a file of cameras."""
    path = folder / f"a{suffix}"
    path.write_bytes(content)
    if name == "opencv":
        storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_READ)
        keys = ("M1", "D1", "R", "T", "camera_matrix", "distortion_coefficients")
        found = [storage.getNode(key).mat() for key in keys if not storage.getNode(key).empty()]
        assert found
        return list(found)
    if suffix == ".xml":
        return [ET.tostring(ET.fromstring(content))]  # noqa: S314 - our own
    others = {
        "matlab": lambda: [str(scipy.io.loadmat(io.BytesIO(content), simplify_cells=True))],
        "anipose": lambda: [tomllib.loads(content.decode())],
        "matchid": lambda: [line for line in content.splitlines() if not line.startswith(b"#")],
    }
    if name in others:
        return others[name]()
    if name == "mrcal":
        assert content.startswith(b"# camera: ")
        return [yaml.safe_load(content)]
    return [json.dumps(yaml.safe_load(content))]


def test_marked_corners_are_read_by_others() -> None:
    content = b"# filename x y weight\na.png 1.5 2.5 1.0\n- - - -\n"
    lines = VNL_COMMENT.put(content).decode().splitlines()
    legend = next(line for line in lines if not line.startswith("##"))  # as vnlog has it
    assert legend == "# filename x y weight"
    assert [line for line in lines if not line.startswith("#")] == content.decode().splitlines()[1:]
    assert np.loadtxt(lines[:3], usecols=(1, 2)).tolist() == [1.5, 2.5]


def test_a_format_of_labcals_own_is_its_own_mark() -> None:
    mark = FormatMark(lambda content: content.startswith(b"view,"))
    assert mark.put(b"view,1") == b"view,1"
    assert mark.judge(b"view,1") is Judgement.AS_WRITTEN
    assert mark.judge(b"x") is Judgement.UNMARKED
