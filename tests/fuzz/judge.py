"""What a careful reader finds in what was accepted; nothing here is the program's own code."""

import csv
import io
import json
import math
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

MOST_STDERR = 8000
_CONTROL = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069]")
_PYTHON = re.compile(r"Traceback|\w+Warning: |labcal itself failed")
DONE, PARTIAL, UNUSABLE = 0, 1, 2


def faults_of_ending(status: int, said: str, result: str) -> list[str]:
    """Return what is wrong with how a command ended, whatever it was given."""
    faults = []
    if status not in {DONE, PARTIAL, UNUSABLE}:
        faults.append(f"status {status}: {said[-300:]}")
    if len(said) > MOST_STDERR:
        faults.append(f"{len(said)} characters on stderr")
    if _CONTROL.search(said):
        faults.append(f"control characters on stderr: {_CONTROL.search(said)[0]!r}")
    if _PYTHON.search(said):
        faults.append(f"stderr speaks Python: {_PYTHON.search(said)[0]} {said[-300:]}")
    if _CONTROL.search(result):
        faults.append("control characters on stdout")
    if status == UNUSABLE and not said.strip():
        faults.append("refused without a word")
    try:
        document = json.loads(result, parse_constant=_no_constant)
    except ValueError as error:
        return [*faults, f"stdout is no JSON: {error}"]
    if not all(math.isfinite(value) for value in _numbers(document)):
        faults.append("a number in the result is not finite")
    return faults


def _no_constant(word: str) -> float:
    raise ValueError(word)


def _numbers(node: Any) -> Iterator[float]:
    if isinstance(node, dict):
        for value in node.values():
            yield from _numbers(value)
    elif isinstance(node, list):
        for value in node:
            yield from _numbers(value)
    elif isinstance(node, int | float) and not isinstance(node, bool):
        yield float(node)


def faults_of_output(path: Path, result: str, output: str) -> list[str]:
    """Return what is wrong with what a command wrote, or showed of a target."""
    if output == "target":
        return _target(json.loads(result))
    if not path.exists():
        return []
    text = path.read_text(encoding="utf-8")
    if output == "out.json":
        return [
            fault for name, camera in json.loads(text)["cameras"].items() for fault in _camera(name, camera)
        ]
    if output == "out.csv":
        lines = list(csv.DictReader(io.StringIO(text)))
        return _points(lines) if "X_mm" in (lines[0] if lines else {}) else _detections(lines)
    return []


def _camera(name: str, camera: dict[str, Any]) -> list[str]:
    (fx, skew, cx), (zero, fy, cy), last = camera["K"]
    width, height = camera["size"]
    faults = []
    if not all(math.isfinite(value) for value in _numbers(camera)):
        return [f"{name}: a number is not finite"]
    if not (1 <= width <= 1e5 and 1 <= height <= 1e5):
        faults.append(f"{name}: a size of {width} x {height}")
    if not (0.005 * width < fx < 1e4 * max(width, height) and 0.02 < fx / fy < 50):
        faults.append(f"{name}: focal lengths of {fx} and {fy}")
    if skew or zero or last != [0.0, 0.0, 1.0] or max(abs(cx), abs(cy)) > 50 * max(width, height):
        faults.append(f"{name}: no camera matrix")
    if max(map(abs, camera["dist"])) > 1e20:
        faults.append(f"{name}: coefficients of {max(camera['dist'], key=abs)}")
    return faults + _pose(name, camera["T_cam_world"])


def _pose(name: str, T: list[list[float]]) -> list[str]:
    R = [row[:3] for row in T[:3]]
    for i in range(3):
        for j in range(3):
            if abs(sum(R[i][k] * R[j][k] for k in range(3)) - (i == j)) > 1e-5:
                return [f"{name}: no rotation"]
    (a, b, c), (d, e, f), (g, h, k) = R
    if a * (e * k - f * h) - b * (d * k - f * g) + c * (d * h - e * g) < 0.9:
        return [f"{name}: a reflection"]
    far = max(abs(row[3]) for row in T[:3]) > 1e10 or T[3] != [0.0, 0.0, 0.0, 1.0]
    return [f"{name}: placed nowhere"] if far else []


_NOWHERE = {"no-solution", "too-few-cameras", "outside-picture"}


def _points(lines: list[dict[str, str]]) -> list[str]:
    keys = [(line["view"], line.get("point"), line.get("col"), line.get("row")) for line in lines]
    faults = ["the same dot twice"] if len(set(keys)) < len(keys) else []
    for line in lines:
        place = [float(line[key]) for key in ("X_mm", "Y_mm", "Z_mm")]
        if line["flag"] not in _NOWHERE and not all(abs(value) <= 1e10 for value in place):
            return [*faults, f"a point at {place} is {line['flag']}"]
        variances = [float(line[key]) for key in ("cov_xx", "cov_yy", "cov_zz")]
        if any(value < 0 or math.isinf(value) for value in variances):
            return [*faults, f"variances of {variances}"]
    return faults


def _detections(lines: list[dict[str, str]]) -> list[str]:
    keys = [
        (line["view"], line["camera"], line["col"], line["row"]) for line in lines if line["flag"] == "ok"
    ]
    faults = ["the same dot twice"] if len(set(keys)) < len(keys) else []
    for line in lines:
        if line["flag"] == "ok":
            x, y, size = (
                float(line["x_px"]),
                float(line["y_px"]),
                (int(line["width_px"]), int(line["height_px"])),
            )
            if not (min(size) >= 1 and max(size) <= 1e5 and -size[0] <= x <= 2 * size[0]):
                return [*faults, f"a dot at {x}, {y} in a picture of {size}"]
            if not all(float(line[key]) > 0 for key in ("var_xx", "var_yy")):
                return [*faults, "a variance that is none"]
    return faults


def _target(target: dict[str, Any]) -> list[str]:
    if "targets" in target:
        return [f"{one['name']}: {fault}" for one in target["targets"] for fault in _target(one)]
    faults = [
        f"{key} is {value}"
        for key, value in target.items()
        if key.endswith("_mm") and value is not None and not (0 <= value <= 1e10)
    ]
    lengths = ("pitch_x_mm", "pitch_y_mm", "dot_diameter_mm", "square_mm", "marker_mm")
    faults += [f"{key} is nothing" for key in lengths if key in target and not target[key] > 1e-7]
    if "dot_diameter_mm" in target and target["dot_diameter_mm"] >= max(
        target["pitch_x_mm"], target["pitch_y_mm"]
    ):
        faults.append("dots larger than the pitch")
    counts = target.get("squares") or [target["cols"], target["rows"]]
    if not all(2 <= count <= 1000 for count in counts):
        faults.append(f"{counts} dots")
    return faults
