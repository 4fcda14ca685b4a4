"""The names of the package itself, each of which is imported when it is first used."""

import subprocess
import sys

import labcal

HEAVY = "numpy scipy sklearn cv2 torch numba mitsuba drjit pydantic dask matplotlib"


def test_every_name_leads_somewhere() -> None:
    assert {"pipeline", "Rig", "Shoot", "Detections", "LabcalError"} <= set(labcal.__all__)
    for name in labcal.__all__:
        assert getattr(labcal, name) is not None
        assert name in dir(labcal)


def test_the_package_imports_nothing_heavy() -> None:
    code = f"import sys, labcal; print([name for name in '{HEAVY}'.split() if name in sys.modules])"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"
