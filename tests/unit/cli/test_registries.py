"""``labcal lens list``, ``method list`` and ``format list``, and that what they say of methods is true."""

import json
from typing import Any

import numpy as np
import pytest

from labcal.cameras.interop.registry import FORMATS, READ, READ_ONLY
from labcal.cameras.lens import LENSES
from labcal.cli import console, convert, main
from labcal.errors import InputError
from labcal.estimators.registry import make_estimator, method_entries, method_names

Capture = pytest.CaptureFixture[str]


def document(capsys: Capture, *words: str) -> dict[str, Any]:
    assert main([*words, "--json"]) == 0
    found: dict[str, Any] = json.loads(capsys.readouterr().out)
    return found


def test_lenses_are_those_of_the_registry_with_their_coefficients(capsys: Capture) -> None:
    told = document(capsys, "lens", "list")
    assert [one["lens"] for one in told["lenses"]] == list(LENSES)
    by_name = {one["lens"]: one for one in told["lenses"]}
    assert by_name["brown5"]["coefficients"] == ["k1", "k2", "p1", "p2", "k3"]
    assert by_name["brown5"]["opencv"] == "cv2.projectPoints"
    assert by_name["thin-prism12"]["formats"] == ["labcal", "opencv", "mrcal", "dice"]
    assert not by_name["fisheye-kb4"]["rectilinear"]
    assert told["prescriptions"] == ["double-gauss", "webcam-doublet"]


def test_formats_are_those_of_the_registry_with_what_they_hold(capsys: Capture) -> None:
    told = document(capsys, "format", "list")
    assert [one["format"] for one in told["formats"]] == list(READ)
    by_name = {one["format"]: one for one in told["formats"]}
    assert (by_name["colmap"]["folder"], by_name["ros"]["folder"]) == (True, False)
    assert (by_name["mrcal"]["unit"], by_name["dice"]["unit"]) == ("m", "mm")
    assert by_name["opencv"]["options"] == ["--unit", "--size", "--lens", "--key"]
    assert by_name["labcal"]["lenses"] == list(LENSES)
    assert "fisheye-kb4" not in by_name["dice"]["lenses"]
    assert told["detections"] == ["detections.csv", "corners.vnl"]
    assert list(FORMATS) == convert._FORMATS.split(", ")  # of the help, which imports nothing
    assert list(READ_ONLY) == convert._READ_ONLY.split(", ")
    assert [one["format"] for one in told["formats"] if not one["written"]] == list(READ_ONLY)


def test_methods_are_those_of_the_registry_and_of_the_help_of_fit(capsys: Capture) -> None:
    told = document(capsys, "method", "list")
    assert [one["method"] for one in told["methods"]] == list(method_entries())
    assert sorted(one["method"] for one in told["methods"]) == method_names()
    assert told["methods"][0]["method"] == "hybrid"
    assert all(one["summary"] and one["needs"] for one in told["methods"])
    assert main(["fit", "--help"]) == 0
    assert ", ".join(method_entries()) in " ".join(capsys.readouterr().out.split())


@pytest.mark.parametrize(("verb", "names"), [("lens", LENSES), ("method", method_names()), ("format", READ)])
def test_a_table_is_whole_in_80_columns(
    verb: str, names: list[str], capsys: Capture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(console, "_WIDTH_OF_A_FILE", 80)
    assert main([verb, "list"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert max(map(len, lines)) <= 80
    assert not any("…" in line for line in lines)
    first = {line.split()[1] for line in lines if line.startswith("│ ") and not line.startswith("│  ")}
    assert first == set(names)


def views(points: np.ndarray, cameras: int) -> np.ndarray:
    """Return pixels of pinholes side by side, 2 m above the points."""
    eyes = ((-300.0, 0.0, -2000.0), (300.0, 20.0, -2100.0))[:cameras]
    seen = [points - np.array(eye) for eye in eyes]
    return np.hstack([800.0 * one[:, :2] / one[:, 2:] + 320.0 for one in seen])


@pytest.mark.parametrize("name", method_names())
def test_what_a_method_needs_is_what_it_refuses_to_be_without(name: str) -> None:
    needs = method_entries()[name].needs
    rng = np.random.default_rng(6)
    volume = rng.uniform(-300.0, 300.0, (60, 3))
    plane = volume * [1.0, 1.0, 0.0]

    def learns(points: np.ndarray, cameras: int = 2) -> bool:
        estimator = make_estimator(name)
        known = estimator.get_params()
        wanted = {"max_epochs": 3, "restarts": 1, "hidden": (3,), "lens": "pinhole"}
        estimator.set_params(**{key: value for key, value in wanted.items() if key in known})
        try:
            estimator.fit(views(points, cameras), points)
        except InputError:
            return False
        return True

    assert learns(plane) == ("not all on one plane" not in needs)
    assert learns(volume) == ("on one plane of constant Z" not in needs)
    assert learns(plane if name == "homography" else volume, 1) == ("any number of cameras" in needs)
    least = {"dlt": 6, "homography": 4, "quadratic": 15, "affine": 5, "ray-net": 6}.get(name)
    if least is not None:
        assert f"{least} " in needs
        some = plane if name == "homography" else volume
        assert learns(some[:least])
        assert not learns(some[: least - 1])
