"""Mutated tables, corners, targets and lists of pictures: refused, or read to what they state."""

import csv
import io
import math
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from fuzz.faithful import Reading
from fuzz.file_mutants import file_mutants
from labcal.correspond.detections_csv import read_detections
from labcal.correspond.interop.corners_vnl import read_corners
from labcal.correspond.interop.pixels.dlc import read_dlc
from labcal.correspond.interop.pixels.exchange import PixelOptions
from labcal.correspond.named_pixels import NamedPixels
from labcal.correspond.named_pixels_csv import read_pixels
from labcal.correspond.picture_lists import listed_pictures
from labcal.errors import LabcalError
from labcal.targets.catalogue import load_target
from labcal.targets.chessboard import Chessboard

Found = list[tuple[object, ...]]
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?|nan")
_LIKELY = 0.6
_BOARD = Chessboard(kind="chessboard", name="board", cols=5, rows=4, square_mm=20.0)
"""Of 5 x 4 corners."""


@dataclass(frozen=True)
class Table:
    """A kind of file."""

    name: str
    text: str
    """A small one."""
    read: Callable[[Path], Found]
    """By labcal."""
    stated: Callable[[str], Found]
    """By a reader that shares no code with it."""
    file: str = ""
    """Its path in the folder; ``board.yaml`` of a target, else ``table.txt``, where left out."""

    @property
    def place(self) -> str:
        """The path of the file in its folder."""
        return self.file or ("board.yaml" if self.name.startswith("target") else "table.txt")

    @property
    def is_in_part(self) -> bool:
        """True where each number that is stated must be read, and others may have been left out."""
        return self.name.startswith(("target", "document"))


def number_of(word: str) -> float:
    """Return a decimal number; raise ``ValueError`` where a word is none."""
    if not _NUMBER.fullmatch(word.strip(" \t\r\n")):
        raise ValueError(word)
    return float(word)


def table_rows(text: str) -> list[dict[str, str]]:
    """Return the lines of a table by their columns."""
    return list(csv.DictReader(io.StringIO(text)))


def _detections() -> str:
    head = "view,camera,image,width_px,height_px,col,row,x_px,y_px,var_xx,var_xy,var_yy,flag"
    lines = [
        f"v{view},{camera},v{view}_{camera}.png,640,480,{n % 3},{n // 3},{31.25 * n + view:.6f},"
        f"{17.5 * n + 3 + len(camera):.6f},0.0004,1e-06,0.00{3 + n},ok"
        for view in range(2) for camera in ("left", "right") for n in range(6)
    ]  # fmt: skip
    return "\n".join([head, *lines, "v0,left,v0_left.png,640,480,,,nan,nan,nan,nan,nan,hidden"]) + "\n"


def _read_detections(path: Path) -> Found:
    table = read_detections(path)
    return [
        (str(table.view[i]), str(table.camera[i]), str(table.image[i]), *map(float, table.size[i]),
         *(map(float, table.index[i]) if table.has_id[i] else (math.nan, math.nan)),
         *map(float, table.position[i]), float(table.covariance[i, 0, 0]), float(table.covariance[i, 0, 1]),
         float(table.covariance[i, 1, 1]), str(table.flag[i]))
        for i in range(len(table))
    ]  # fmt: skip


def _stated_detections(text: str) -> Found:
    found: Found = []
    for row in table_rows(text):
        numbers = [
            number_of(row[key] or "nan")
            for key in ("col", "row", "x_px", "y_px", "var_xx", "var_xy", "var_yy")
        ]
        if math.isnan(numbers[0]) or math.isnan(numbers[1]):
            numbers[:2] = [math.nan, math.nan]
        sizes = number_of(row["width_px"]), number_of(row["height_px"])
        found.append((row["view"], row["camera"], row["image"], *sizes, *numbers, row["flag"]))
    return found


def _pixels() -> str:
    lines = [f"{v},{c},p{n},{20.5 * n + len(c):.4f},{11.25 * n + 2:.4f},0.01,0.001,0.02"
             for v in ("a", "b") for c in ("left", "right") for n in range(4)]  # fmt: skip
    return "\n".join(["view,camera,point,x_px,y_px,var_xx,var_xy,var_yy", *lines]) + "\n"


def _of_pixels(table: NamedPixels) -> Found:
    return [
        (str(table.view[i]), str(table.camera[i]), str(table.point[i]), *map(float, table.position[i]),
         float(table.covariance[i, 0, 0]), float(table.covariance[i, 0, 1]), float(table.covariance[i, 1, 1]))
        for i in range(len(table))
    ]  # fmt: skip


def _stated_pixels(text: str) -> Found:
    keys = ("x_px", "y_px", "var_xx", "var_xy", "var_yy")
    return [(row["view"], row["camera"], row["point"], *(number_of(row[key] or "nan") for key in keys))
            for row in table_rows(text)]  # fmt: skip


def _corners() -> str:
    lines = [
        f"f{view}.png {40.5 * (n % 5) + 30 + view:.4f} {33.25 * (n // 5) + 20 + n:.4f} {n % 2}"
        for view in range(3) for n in range(20)
    ]  # fmt: skip
    return "\n".join(["# filename x y level", *lines[:40], "f8.png - - -", *lines[40:]]) + "\n"


def _read_corners(path: Path) -> Found:
    table = read_corners(path, _BOARD, {}, lambda _: (640, 480)).detections
    return [
        (str(table.image[i]), *map(float, table.index[i]), *map(float, table.position[i]),
         float(table.covariance[i, 0, 0]))
        for i in range(len(table)) if table.ok[i]
    ]  # fmt: skip


def _stated_corners(text: str) -> Found:
    images: dict[str, list[list[str]]] = {}
    for line in text.split("\n"):
        words = line.split()
        if words and not words[0].startswith("#"):
            images.setdefault(words[0], []).append(words[1:])
    found: Found = []
    for image, lines in images.items():
        points = []
        for n, words in enumerate(lines):
            if "-" in words:
                continue
            x, y, level = (number_of(word) for word in words)
            if min(x, y, level) >= 0.0:
                points.append((image, float(n % 5), float(3 - n // 5), x, y, 4.0**level))
        found += sorted(points, key=lambda one: (one[2], one[1]))
    return found


_TARGETS = {
    "grid": "name: small\ncols: 6\nrows: 5\npitch_x_mm: 20.0\npitch_y_mm: 21.5\ndot_diameter_mm: 8.25\n"
    "ring_outer_diameter_mm: 12.5\nring_inner_diameter_mm: 5.0\n"
    "rings: {origin: [1, 1], x: [4, 1], y: [1, 3]}\nmargin_mm: 15.0\n",
    "chessboard": "kind: chessboard\nname: chess\ncols: 9\nrows: 6\nsquare_mm: 25.5\n",
    "charuco": "kind: charuco\nname: board\nsquares: [5, 4]\nsquare_mm: 20.5\nmarker_mm: 15.25\n"
    "dictionary: DICT_5X5_100\npattern: current\nfirst_id: 7\nmargin_mm: 10.0\n",
    "kalibr": "target_type: 'aprilgrid'\ntagCols: 6\ntagRows: 5\ntagSize: 0.0885\ntagSpacing: 0.31\n",
}


def leaves(node: Any, path: str = "") -> Iterator[tuple[str, object]]:
    """Yield the values in a tree with the keys that lead to them."""
    if isinstance(node, dict):
        for key, value in node.items():
            yield from leaves(value, f"{path}.{key}")
    elif isinstance(node, list | tuple):
        for n, value in enumerate(node):
            yield from leaves(value, f"{path}.{n}")
    else:
        yield path, node


def numbers_in(tree: object) -> Found:
    """Return the numbers in a tree with the keys that lead to them."""
    return [
        (key, float(value))
        for key, value in leaves(tree)
        if isinstance(value, int | float) and not isinstance(value, bool)
    ]


def _read_target(path: Path) -> Found:
    return numbers_in(load_target(str(path)).model_dump(mode="json"))


def _stated_target(text: str) -> Found:
    found: Found = []
    for key, value in leaves(yaml.load(text, yaml.BaseLoader)):  # noqa: S506 -- words only
        if _NUMBER.fullmatch(str(value)):
            found.append((key, float(str(value))))
    return found


def _stated_kalibr(text: str) -> Found:
    stated = dict(_stated_target(text))
    keys = ("tag_cols", "tagCols"), ("tag_rows", "tagRows"), ("tag_spacing", "tagSpacing")
    size = round(1000.0 * float(str(stated[".tagSize"])), 9)
    return [(".tag_mm", size), *((f".{ours}", stated[f".{theirs}"]) for ours, theirs in keys)]


def _dlc() -> str:
    lines = [f"{n},{10.5 * n + 1},{20.25 + n},0.9{n},{30.5 + n},{7.75 * n + 1},0.8{n}" for n in range(5)]
    head = [
        "scorer,a,a,a,a,a,a",
        "bodyparts,paw,paw,paw,nose,nose,nose",
        "coords,x,y,likelihood,x,y,likelihood",
    ]
    return "\n".join([*head, *lines]) + "\n"


def _read_dlc(path: Path) -> Found:
    table = read_dlc([path], PixelOptions()).pixels
    return [
        (str(table.view[i]), str(table.point[i]), *map(float, table.position[i])) for i in range(len(table))
    ]


def _stated_dlc(text: str) -> Found:
    rows = [row for row in csv.reader(io.StringIO(text)) if row]
    found: Found = []
    for row in rows[3:]:
        for at in range(1, len(row)):
            if rows[2][at] != "x":
                continue
            x, y, likelihood = (number_of(row[at + n] or "nan") for n in range(3))
            if likelihood >= _LIKELY and not math.isnan(x):
                found.append((row[0].strip(), rows[1][at], x, y))
    return found


def _read_list(path: Path) -> Found:
    return [(Path(one).name,) for one in listed_pictures(path)]


def _stated_list(text: str) -> Found:
    return [
        (line.strip(),) for line in text.splitlines() if line.strip() and not line.strip().startswith("#")
    ]


TABLES = {
    one.name: one
    for one in (
        Table("detections", _detections(), _read_detections, _stated_detections),
        Table("pixels", _pixels(), lambda path: _of_pixels(read_pixels(path)), _stated_pixels),
        Table("corners", _corners(), _read_corners, _stated_corners),
        Table("dlc", _dlc(), _read_dlc, _stated_dlc),
        Table("list", "# left\na1.png\na10.png\n\nb1.png\nb2.png\n", _read_list, _stated_list),
        *(Table(f"target-{kind}", text, _read_target, _stated_kalibr if kind == "kalibr" else _stated_target)
          for kind, text in _TARGETS.items()),
    )
}  # fmt: skip
"""By name."""


def table_readings(table: Table, folder: Path, seed: int, count: int) -> Iterator[Reading]:
    """Yield what comes of mutants of a kind of table; parameters as of :func:`fuzz.faithful.readings`."""
    name = table.name
    rng = np.random.default_rng([seed, *name.encode()])
    for picture in ("a1.png", "a10.png", "b1.png", "b2.png"):
        (folder / picture).touch()
    (folder / "right.txt").write_text("b1.png\nb2.png\n", encoding="utf-8")
    path = folder / table.place
    path.parent.mkdir(exist_ok=True)
    data = table.text.encode()
    path.write_bytes(data)
    meant = table.read(path)
    if not _same(meant, table.stated(table.text), table):
        raise RuntimeError(f"The judge of {name} reads another thing than labcal before any mutation.")
    for number, mutant in enumerate(file_mutants(data, rng, count, binary=False), 1):
        path.write_bytes(mutant)
        try:
            found = table.read(path)
        except LabcalError:
            yield Reading(number, path.name, mutant, True, ())
            continue
        except Exception as error:  # noqa: BLE001 -- that is what is looked for
            yield Reading(number, path.name, mutant, False, (f"{type(error).__name__}: {error}",))
            continue
        try:
            stated, why = table.stated(mutant.decode("utf-8-sig").replace("\r\n", "\n")), ""
        except Exception as error:  # noqa: BLE001 -- a small reader fails as it likes
            stated, why = meant, f" (the other reader: {type(error).__name__} {error})"
        same = _same(found, stated, table)
        yield Reading(number, path.name, mutant, False, () if same else (f"another content{why}",))


def _same(found: Found, stated: Found, table: Table) -> bool:
    """Tell whether what was read is what is stated; of a document, each number that is stated."""
    if table.is_in_part:
        there = dict(found)
        return all(key in there and _equal(there[key], value) for key, value in stated)
    return len(found) == len(stated) and all(
        len(a) == len(b) and all(map(_equal, a, b)) for a, b in zip(found, stated, strict=True)
    )


def _equal(a: object, b: object) -> bool:
    if isinstance(a, float) and isinstance(b, float):
        return (math.isnan(a) and math.isnan(b)) or abs(a - b) <= 1e-12 * max(1.0, abs(b))
    return a == b
