"""What a verb imports: no more than it works with, so that each starts within a second of processor time."""

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

Run = Callable[..., Any]

HEAVY = frozenset(
    {"cv2", "drjit", "matplotlib", "mitsuba", "numba", "pandas", "scipy", "scipy.optimize"}
    | {"scipy.spatial", "scipy.stats._stats_py", "sklearn", "torch"}
)
"""``scipy.stats`` itself is there before it is loaded, see `labcal.estimators.scikit_learn`."""
RUN = (
    "import sys; from labcal.cli import main; status = main(sys.argv[1:]); print(*sys.modules); exit(status)"
)


def heavy_modules(code: str, *words: object) -> set[str]:
    """Return which of the heavy modules a program of its own has imported when it ends well."""
    told = subprocess.run(
        [sys.executable, "-c", code, *map(str, words)], capture_output=True, text=True, check=False
    )
    assert told.returncode == 0, told.stderr
    return HEAVY & set(told.stdout.splitlines()[-1].split())


@pytest.fixture(scope="module")
def rig(labcal: Run, handheld: Path, handheld_dots: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A rig of the hand-held shoot."""
    path = tmp_path_factory.mktemp("rig") / "rig.json"
    words = ("--detections", handheld_dots, "--lens", "brown-k1k2", "-o", path)
    assert labcal("calibrate", handheld, *words).status < 2
    return path


def test_importing_the_chain_imports_neither_scipy_nor_numba() -> None:
    assert heavy_modules("import sys, labcal.pipeline; print(*sys.modules)") <= {"cv2"}


def test_every_public_name_of_the_chain_is_there() -> None:
    code = (
        "import sys, labcal.pipeline as p; assert all(hasattr(p, n) for n in p.__all__) and "
        "set(p.__all__) <= set(dir(p)); assert not hasattr(p, 'no_such_name'); print(*sys.modules)"
    )
    assert "sklearn" in heavy_modules(code)  # the methods are among them


def test_detection_imports_opencv_and_numba(stage: Path, tmp_path: Path) -> None:
    picture = min((stage / "images").iterdir())
    words = ("--target", "paper-13x10", "-o", tmp_path / "dots.csv", "--workers", 1)
    # Numba itself imports SciPy, when it loads machine code.
    assert heavy_modules(RUN, "detect", picture, *words) <= {"cv2", "numba", "scipy"}


def test_calibration_imports_no_detector_and_no_methods(
    handheld: Path, handheld_dots: Path, tmp_path: Path
) -> None:
    words = ("--detections", handheld_dots, "--lens", "brown-k1k2", "-o", tmp_path / "rig.json")
    found = heavy_modules(RUN, "calibrate", handheld, *words)
    assert found <= {"cv2", "scipy", "scipy.optimize", "scipy.spatial"}


def test_conversion_imports_what_the_format_needs(rig: Path, tmp_path: Path) -> None:
    yaml, colmap = tmp_path / "stereo.yml", tmp_path / "colmap"
    assert heavy_modules(RUN, "convert", rig, yaml, "--to", "opencv") <= {"cv2"}
    found = heavy_modules(RUN, "convert", rig, colmap, "--to", "colmap")
    assert found <= {"cv2", "scipy", "scipy.spatial"}


def test_reconstruction_by_a_rig_and_evaluation_import_no_methods(
    rig: Path, handheld: Path, handheld_dots: Path, tmp_path: Path
) -> None:
    points = tmp_path / "points.csv"
    found = heavy_modules(RUN, "reconstruct", rig, handheld_dots, "-o", points)
    assert found <= {"cv2", "scipy", "scipy.spatial"}
    assert heavy_modules(RUN, "evaluate", points, handheld) <= {"cv2", "scipy", "scipy.spatial"}


def test_methods_import_scikit_learn_without_scipys_statistics(
    stage: Path, stage_dots: Path, tmp_path: Path
) -> None:
    model, points = tmp_path / "model", tmp_path / "points.csv"
    words = ("--detections", stage_dots, "--method", "affine", "-o", model)
    most = {"cv2", "scipy", "scipy.optimize", "scipy.spatial", "sklearn"}
    most |= {"pandas"}  # which scikit-learn imports where it is installed
    assert heavy_modules(RUN, "fit", stage, *words) <= most
    assert "sklearn" in heavy_modules(RUN, "reconstruct", model, stage_dots, "-o", points) <= most


def test_scipys_statistics_are_whole_when_they_are_used() -> None:
    code = (
        "import sys; import labcal.estimators.affine, scipy.stats; early = set(sys.modules); "
        "assert scipy.stats.norm.ppf(0.5) == 0.0; from scipy.stats import chi2; import scipy.stats as again; "
        "assert again.chi2 is chi2; assert type(again).__name__ == 'module'; print(*early)"
    )
    assert "scipy.stats._stats_py" not in heavy_modules(code)
