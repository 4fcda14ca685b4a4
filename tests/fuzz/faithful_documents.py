"""Mutated documents and further tables: refused, or read to the numbers that they state."""

import json
import math
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from fuzz.faithful_tables import Found, Table, leaves, number_of, numbers_in, table_rows
from fuzz.seeds import LENS_YAML, SCENE_YAML, TARGET, TARGET_YAML
from labcal.cameras.prescription import load_prescription
from labcal.capture.stage import read_stage
from labcal.correspond.camera_lists import list_sources
from labcal.correspond.detections_csv import read_detections
from labcal.correspond.interop.pixels.colmap_tracks import read_tracks
from labcal.correspond.interop.pixels.dice_subsets import read_dice
from labcal.correspond.interop.pixels.exchange import PixelOptions
from labcal.correspond.interop.pixels.named_columns import read_columns
from labcal.correspond.named_pixels import NamedPixels
from labcal.correspond.named_points_csv import read_named_points
from labcal.correspond.points_csv import read_points
from labcal.correspond.table_lines import PointLines
from labcal.evaluate.acceptance.reference_lengths import read_lengths
from labcal.guide.check_log import read_check_log
from labcal.guide.rehearsal.catalogue import load_rig_plan
from labcal.reconstruct.frames.known_points import read_known_points
from labcal.run.json_text import to_json
from labcal.scene.catalogue import load_scene
from labcal.shoot.dataset import open_shoot
from labcal.shoot.tone_curve import MeasuredCurve, find_tone_curve
from labcal.shoot.truth import read_true_dots, read_truth
from labcal.targets.catalogue import load_target
from labcal.targets.places import DotPlaces, read_places

_HALF = 0.5
_COVARIANCE = ("cov_xx", "cov_xy", "cov_xz", "cov_yy", "cov_yz", "cov_zz")
_CHARUCO = (
    "{kind: charuco, name: NAME, squares: [5, 4], square_mm: 20.5, marker_mm: 15.25, "
    "dictionary: DICT_5X5_250, first_id: 7}"
)
_CHESSBOARD = "{kind: chessboard, name: b, cols: 9, rows: 6, square_mm: 25.5}"
_PLACES = """places:
  - T_set_board: [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]]
  - T_set_board: [[0.6, -0.8, 0.0, 310.5], [0.8, 0.6, 0.0, 12.5], [0.0, 0.0, 1.0, -3.7], [0.0, 0.0, 0.0, 1.0]]
    sigma_rotation_rad: [0.001, 0.0012, 0.0015]
    sigma_mm: [0.04, 0.05, 0.16]
"""
_SET = f"name: plate\ntargets:\n  - {_CHARUCO.replace('NAME', 'a')}\n  - {_CHESSBOARD}\n"
TARGETS = {
    "boards": _SET + "mounting: rigid\n",
    "boards-places": _SET + _PLACES,
    "aprilgrid": "kind: aprilgrid\nname: april\ntag_cols: 6\ntag_rows: 5\ntag_mm: 88.5\ntag_spacing: 0.31\n"
    "first_id: 3\nborder_cells: 2\n",
    "coded-dots": "kind: coded-dots\nname: coded\ncode: ring-23\nfirst_mark: 5\ncols: 6\nrows: 4\n"
    "pitch_mm: 40.5\ndot_diameter_mm: 9.25\nmargin_mm: 20.5\n",
    "asymmetric": "name: a\nlayout: asymmetric\ncols: 4\nrows: 11\npitch_x_mm: 40.5\npitch_y_mm: 20.25\n"
    "dot_diameter_mm: 12.5\nrings: null\n",
}
"""Descriptions of targets, by kind."""
_PLAN = (
    "name: pair\ncamera: {size: [1600, 1200], focal_mm: 12.5, pixel_um: 4.5, lens: brown5, "
    "dist: [-0.08, 0.05, 0.0003, -0.0002, 0.001]}\n"
    "geometry: {kind: pair, baseline_mm: 800.5, convergence_mm: 693.25}\n"
    "volume: {width_mm: 220.5, height_mm: 180.25, near_mm: 600.5, far_mm: 780.75}\n"
    f"target:\n{''.join(f'  {line}' + chr(10) for line in TARGET_YAML.splitlines())}"
    "print_sigma_mm: 0.0125\nshoot: {views: 14, tilt_max_deg: 30.5}\n"
)
_CHECKS = "\n".join(
    json.dumps(
        {
            "date": f"2026-11-0{n}T10:00:00",
            "rig": "rig.json",
            "verdict": "valid",
            "p_value": 0.25 * n,
            "camera": None,
            "kind": None,
            "turn_deg": None,
            "shift_mm": None,
            "focus_percent": None,
            "cost_rms_mm": 0.0125 * n,
            "budget_mm": 0.5,
            "views": 4 + n,
            "sigma0": 1.0625,
            "temperature_c": 20.5,
            "note": "",
        }
    )
    for n in (1, 2, 3)
)


def _dumped(load: Callable[[str], Any], path: Path) -> Found:
    """Return the numbers of what is loaded, by their keys."""
    return numbers_in(load(str(path)).model_dump(mode="json"))


def _read_plan(path: Path) -> Found:
    """Return the numbers of a plan; all cameras are alike, and stated once."""
    return [
        (str(key).replace(".cameras.left.", ".camera."), *rest) for key, *rest in _dumped(load_rig_plan, path)
    ]


def _stated_yaml(text: str) -> Found:
    """Return the numbers that a YAML document states, by their keys; words only are read."""
    found: Found = []
    for key, value in leaves(yaml.load(text, yaml.BaseLoader)):  # noqa: S506 -- words only
        try:
            found.append((key, number_of(str(value))))
        except ValueError:
            continue
    return found


def _stated_json(text: str) -> Found:
    """Return the numbers of a JSON document, by their keys."""
    return numbers_in(json.loads(text))


def _stated_lines(text: str) -> Found:
    lines = [line for line in text.splitlines() if line.strip()]
    return [(f"{n}{key}", value) for n, line in enumerate(lines) for key, value in _stated_json(line)]


def _read_lines(path: Path) -> Found:
    every = read_check_log(path)
    return [
        (f"{n}{key}", v) for n, one in enumerate(every) for key, v in numbers_in(one.model_dump(mode="json"))
    ]


def _of_columns(text: str, words: tuple[str, ...], numbers: tuple[str, ...], empty: str = "nan") -> Found:
    """Return the lines of a table: some columns as words, others as numbers."""
    return [
        (*(row[key] for key in words), *(number_of(row[key] or empty) for key in numbers))
        for row in table_rows(text)
    ]


def _points(board: str = "") -> str:
    head = ["view", "col", "row", "X_mm", "Y_mm", "Z_mm", *_COVARIANCE, "flag", *(["board"] if board else [])]
    lines = [
        f"v{view},{n % 3},{n // 3},{31.25 * n + view},{-17.5 * n},{600.25 + n},0.04,0.001,0.002,0.05,0.003,"
        f"0.1{n},ok"
        + (f",{board}-{view}" if board else "")
        for view in range(2) for n in range(6)
    ]  # fmt: skip
    return "\n".join([",".join(head), *lines]) + "\n"


def _of_points(table: PointLines, names: list[tuple[object, ...]]) -> Found:
    upper = np.triu_indices(3)
    return [
        (*names[i], *map(float, table.point[i]), *map(float, table.covariance[i][upper]), str(table.flag[i]))
        for i in range(len(table))
    ]


def _read_points(path: Path) -> Found:
    table = read_points(path)
    names = [
        (str(view), *map(float, index), str(board))
        for view, index, board in zip(table.view, table.index, table.board, strict=True)
    ]
    return _of_points(table, names)


def _stated_points(text: str) -> Found:
    keys = ("X_mm", "Y_mm", "Z_mm", *_COVARIANCE)
    return [
        (row["view"], number_of(row["col"]), number_of(row["row"]), row.get("board", ""),
         *(number_of(row[key] or "nan") for key in keys), row["flag"])
        for row in table_rows(text)
    ]  # fmt: skip


def _read_named(path: Path) -> Found:
    table = read_named_points(path)
    return _of_points(table, [(str(v), str(n)) for v, n in zip(table.view, table.name, strict=True)])


def _stated_named(text: str) -> Found:
    keys = ("X_mm", "Y_mm", "Z_mm", *_COVARIANCE)
    return [
        (row["view"], row["point"], *(number_of(row[key] or "nan") for key in keys), row["flag"])
        for row in table_rows(text)
    ]


def _detections() -> str:
    head = "view,camera,image,width_px,height_px,col,row,x_px,y_px,var_xx,var_xy,var_yy,flag,board"
    lines = [
        f"v{view},left,v{view}.png,640,480,{n % 3},{n // 3},{31.25 * n + view},{17.5 * n + 3},0.0004,1e-06,"
        f"0.00{3 + n},ok,{board}"
        for view in range(2) for board in ("a", "b") for n in range(4)
    ]  # fmt: skip
    return "\n".join([head, *lines]) + "\n"


def _read_boards(path: Path) -> Found:
    table = read_detections(path)
    return [
        (str(table.view[i]), *map(float, table.index[i]), *map(float, table.position[i]), str(table.board[i]))
        for i in range(len(table))
    ]


def _stated_boards(text: str) -> Found:
    return [
        (row["view"], *(number_of(row[key]) for key in ("col", "row", "x_px", "y_px")), row["board"])
        for row in table_rows(text)
    ]


def _read_known(path: Path) -> Found:
    known = read_known_points(path)
    figures = zip(known.name, known.point.tolist(), known.sigma_mm.tolist(), strict=True)
    return [(name, *place, sigma) for name, place, sigma in figures]


def _read_lengths(path: Path) -> Found:
    table = read_lengths(path)
    keys = ("line", "length", "view_a", "point_a", "view_b", "point_b", "nominal_mm", "sigma_mm")
    columns = [getattr(table, key).tolist() for key in keys]
    return [tuple(line) for line in zip(*columns, strict=True)]


def _of_pixels(pixels: NamedPixels) -> Found:
    return [
        (str(pixels.view[i]), str(pixels.camera[i]), str(pixels.point[i]), *map(float, pixels.position[i]))
        for i in range(len(pixels))
    ]


def _stated_tracks(text: str) -> Found:
    lines = [line for line in text.split("\n") if not line.startswith("#")]
    found: Found = []
    for head, pixels in zip(lines[::2], lines[1::2], strict=False):
        if not head.strip():
            if pixels.strip():
                raise ValueError(pixels)
            continue
        image, words = head.split(maxsplit=9)[9].strip(), pixels.split()
        ids = words[2::3]
        for x, y, point in zip(words[::3], words[1::3], ids, strict=True):
            if point != "-1" and ids.count(point) == 1:
                view, camera = image.rsplit(".", 1)[0].rsplit("_", 1)
                found.append((view, camera, f"point-{point}", number_of(x) - _HALF, number_of(y) - _HALF))
    return found


def _stated_sums(text: str, point: str | None, sums: tuple[str, str, str, str]) -> Found:
    """Return the pixels of a table whose coordinates are sums of two columns."""
    rows = [{key.strip(): cell.strip() for key, cell in row.items()} for row in table_rows(text)]
    found: Found = []
    for n, row in enumerate(rows):
        x, y, u, v = (number_of(row[key] or "nan") for key in sums)  # empty: not found
        sigma = number_of(row["sigma" if point is None else "SIGMA"] or "nan")
        if sigma < 0.0 or math.isnan(x + u) or math.isnan(y + v):
            continue
        found.append((str(n) if point is None else row[point], x + u, y + v))
    return found


def _read_stage(path: Path) -> Found:
    return [(one.view, one.role.value, *map(float, one.T_world_target[:3, 3])) for one in read_stage(path)]


def _read_curve(path: Path) -> Found:
    curve = find_tone_curve(path)
    if not isinstance(curve, MeasuredCurve):
        raise TypeError(path)
    return [(float(one), float(other)) for one, other in zip(curve.value, curve.light, strict=True)]


def _read_dots(path: Path) -> Found:
    found: Found = []
    for one in read_true_dots(path.parents[1]):
        figures = np.concatenate([one.index, one.point, one.centre, one.centroid], axis=1)
        found += [
            (one.view, one.camera, *map(float, line), float(seen))
            for line, seen in zip(figures, one.visible, strict=True)
        ]
    return sorted(found, key=str)


def _dots() -> str:
    head = "view,camera,col,row,X_mm,Y_mm,Z_mm,centre_x_px,centre_y_px,centroid_x_px,centroid_y_px,visible"
    lines = [
        f"v{view},left,{n},0,{10.5 * n},{3.25 * view},0.125,{20.5 + n},{30.25 + n},{20.625 + n},{30.5 + n},"
        f"{n % 2}"
        for view in range(2) for n in range(5)
    ]  # fmt: skip
    return "\n".join([head, *lines]) + "\n"


def _pose(n: int) -> list[list[float]]:
    return [[1.0, 0.0, 0.0, 1.25 * n], [0.0, 1.0, 0.0, -2.5], [0.0, 0.0, 1.0, 700.5], [0.0, 0.0, 0.0, 1.0]]


def _manifest() -> str:
    views = [
        {"name": f"v{n}", "images": {"left": f"images/v{n}.png"}, "role": "train",
         "T_world_target_nominal": _pose(n)}
        for n in range(3)
    ]  # fmt: skip
    target = TARGET.model_dump(mode="json")
    cameras = {"left": {"size": [640, 480]}}
    document = {"format": "labcal-shoot", "format_version": 1, "target": target, "cameras": cameras}
    return json.dumps({**document, "views": views}, indent=1)


def _read_manifest(path: Path) -> Found:
    return numbers_in(open_shoot(path.parent).manifest.model_dump(mode="json"))


def _truth() -> str:
    camera = {
        "size": [640, 480], "K": [[700.5, 0.0, 320.25], [0.0, 701.5, 240.75], [0.0, 0.0, 1.0]],
        "lens": "brown5", "dist": [-0.125, 0.03, 0.001, -0.002, 0.01], "T_cam_world": _pose(2),
    }  # fmt: skip
    return json.dumps({"cameras": {"left": camera}, "views": {"v0": {"T_world_target": _pose(1)}}}, indent=1)


def _read_truth(path: Path) -> Found:
    return numbers_in(read_truth(path.parents[1]).model_dump(mode="json"))


def _places() -> str:
    small = TARGET.model_copy(update={"cols": 5, "rows": 4})
    n = small.count
    spread = np.tile(np.diag([1e-6, 2e-6, 3e-6]), (n, 1, 1))
    places = DotPlaces.of(small, small.points() + 0.0125, spread, np.full(n, 5), np.ones(n, dtype=bool))
    return to_json(places.model_dump(mode="json"))


def _read_lists(path: Path) -> Found:
    lists = {"left": str(path), "right": str(path.parent / "right.txt")}
    given = [str(path.parent / name) for name in ("a1.png", "a10.png", "b1.png", "b2.png")]
    sources, _ = list_sources(given, lists)
    return [(Path(one.image).name, one.camera) for one in sources]


def _stated_lists(text: str) -> Found:
    names = [line.strip() for line in text.splitlines() if line.strip() and not line.strip().startswith("#")]
    pairs = zip(names, ("b1.png", "b2.png"), strict=True)
    return [one for name, other in pairs for one in ((name, "left"), (other, "right"))]


_ROWS = range(6)
_DICE = "\n".join(
    ["SUBSET_ID,COORDINATE_X,COORDINATE_Y,DISPLACEMENT_X,DISPLACEMENT_Y,SIGMA",
     *(f"{n},{100.5 + 20 * n},{50.25 + n},{0.5 * n},{-0.25 * n},0.0{n + 1}" for n in _ROWS)]
) + "\n"  # fmt: skip
_VIC = "\n".join(
    ["x,y,u,v,sigma", *(f"{100.5 + 20 * n},{50.25 + n},{0.5 * n},{-0.25 * n},0.0{n + 1}" for n in _ROWS)]
) + "\n"  # fmt: skip
_TRACKS = "# IMAGE_ID\n" + "".join(
    f"{n} 1 0 0 0 0 0 0 1 a{n}_{camera}.png\n100.5 50.25 7 3.75 4.5 -1 20.25 30.5 {9 + n}\n"
    for n, camera in ((1, "left"), (2, "right"))
)
_NAMED = "\n".join(
    [",".join(["view", "point", "X_mm", "Y_mm", "Z_mm", *_COVARIANCE, "flag"]),
     *(f"v{n % 2},p{n},{10.5 * n},{20.25 - n},{700.5 + n},0.04,0.001,0.002,0.05,0.003,0.1{n},ok"
       for n in _ROWS)]
) + "\n"  # fmt: skip
_KNOWN = "point,X_mm,Y_mm,Z_mm,sigma_mm\n" + "".join(
    f"p{n},{10.5 * n},{n}.25,{-n}.5,0.0{n + 1}\n" for n in _ROWS
)
_LENGTHS = "line,length,view_a,point_a,view_b,point_b,nominal_mm,sigma_mm\n" + "".join(
    f"{n // 3},{n},v0,p{n},v1,q{n},{100.5 + n},0.0{n + 1}\n" for n in _ROWS
)
_STAGE = "view,role,X_mm,Y_mm,Z_mm,rx_deg,ry_deg,rz_deg\n" + "".join(
    f"v{n},{'train' if n % 2 else 'test'},{10.5 * n},{n}.25,{-n}.5,{n}.0,0.5,-1.25\n" for n in _ROWS
)
_CURVE = "value,light\n0,0\n0.25,0.125\n0.5,0.375\n0.75,0.625\n1,1\n"
_PIXELS = PixelOptions(cameras={"_left": "left", "_right": "right"})


def _read_dice(path: Path) -> Found:
    return [
        line[2:] for line in _of_pixels(read_dice([path], PixelOptions(cameras={"table": "left"})).pixels)
    ]


def _read_vic(path: Path) -> Found:
    options = PixelOptions(columns="sigma=sigma,left=x+u:y+v")
    return [line[2:] for line in _of_pixels(read_columns([path], options).pixels)]


DOCUMENTS = {
    one.name: one
    for one in (
        *(Table(f"target-{kind}", text, partial(_dumped, load_target), _stated_yaml)
          for kind, text in TARGETS.items()),
        Table("document-scene", SCENE_YAML, partial(_dumped, load_scene), _stated_yaml, "scene.yaml"),
        Table("document-lens", LENS_YAML, partial(_dumped, load_prescription), _stated_yaml, "lens.yaml"),
        Table("document-rig-plan", _PLAN, _read_plan, _stated_yaml, "plan.yaml"),
        Table("document-shoot", _manifest(), _read_manifest, _stated_json, "shoot.json"),
        Table("document-truth", _truth(), _read_truth, _stated_json, "truth/truth.json"),
        Table("document-places", _places(), partial(_dumped, read_places), _stated_json, "places.json"),
        Table("document-checks", _CHECKS, _read_lines, _stated_lines, "checks.jsonl"),
        Table("detections-boards", _detections(), _read_boards, _stated_boards),
        Table("points", _points(), _read_points, _stated_points),
        Table("points-boards", _points("board"), _read_points, _stated_points),
        Table("named-points", _NAMED, _read_named, _stated_named),
        Table("known-points", _KNOWN, _read_known,
              lambda text: _of_columns(text, ("point",), ("X_mm", "Y_mm", "Z_mm", "sigma_mm"), "0")),
        Table("lengths", _LENGTHS, _read_lengths,
              lambda text: _of_columns(text, ("line", "length", "view_a", "point_a", "view_b", "point_b"),
                                       ("nominal_mm", "sigma_mm"), "0")),
        Table("stage", _STAGE, _read_stage,
              lambda text: _of_columns(text, ("view", "role"), ("X_mm", "Y_mm", "Z_mm"))),
        Table("tone-curve", _CURVE, _read_curve,
              lambda text: _of_columns(text, (), ("value", "light")), "curve.csv"),
        Table("true-dots", _dots(), _read_dots,
              lambda text: sorted(_of_columns(text, ("view", "camera"), (
                  "col", "row", "X_mm", "Y_mm", "Z_mm", "centre_x_px", "centre_y_px", "centroid_x_px",
                  "centroid_y_px", "visible")), key=str), "truth/dots.csv"),
        Table("colmap-tracks", _TRACKS, lambda path: _of_pixels(read_tracks([path], _PIXELS).pixels),
              _stated_tracks),
        Table("dice-subsets", _DICE, _read_dice, lambda text: _stated_sums(
            text, "SUBSET_ID", ("COORDINATE_X", "COORDINATE_Y", "DISPLACEMENT_X", "DISPLACEMENT_Y"))),
        Table("columns", _VIC, _read_vic, lambda text: _stated_sums(text, None, ("x", "y", "u", "v"))),
        Table("camera-lists", "# left\na1.png\na10.png\n", _read_lists, _stated_lists, "left.txt"),
    )
}  # fmt: skip
"""By name."""
