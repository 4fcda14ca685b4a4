"""No line of a file of cameras can be lost so that the rest is read to something else.

Second readers share blind spots of the first ones, as stopping at the first gap: here, what was written is
the judge.
"""

import re
from pathlib import Path

import numpy as np
import pytest

from fuzz.faithful import example_of
from fuzz.stated_cameras import READERS, Stated, stated_camera
from fuzz.stated_forms import FORMS
from fuzz.stated_robots import ROBOTS
from labcal.cameras.interop.exchange import Home, ReadOptions
from labcal.cameras.interop.registry import READ
from labcal.cameras.interop.rig_files import read_rig_files
from labcal.cameras.rig import Rig
from labcal.errors import LabcalError

OPTIONAL = {
    "dice": rb'name="(K|P|S|T)[1-6XYZ]"',
    "metashape": rb"<(b1|c[xy]|[kp]\d)>",
}
"""Parameters that these programs leave out where they are zero."""
NAMES = [name for name in (*READERS, *ROBOTS, *FORMS)
         if not READ[name.split(".")[0]].binary and not name.endswith("npz")]  # fmt: skip


@pytest.mark.parametrize("name", NAMES)
def test_a_lost_line_is_seen_or_changes_nothing(name: str, tmp_path: Path) -> None:
    example = example_of(name)
    chosen, meant = READ[example.format_name], example.read(example.files)
    unit = chosen.unit if "unit" in chosen.options else None
    given = ReadOptions(size=(640, 480) if name == "matchid" else None, unit=unit)
    for file, content in example.files.items():
        (tmp_path / file).write_bytes(content)
    inputs = [tmp_path] if chosen.home is Home.FOLDER else [tmp_path / file for file in example.files]
    taken = []
    for file, content in example.files.items():
        lines = content.split(b"\n")
        for at, line in enumerate(lines):
            (tmp_path / file).write_bytes(b"\n".join(lines[:at] + lines[at + 1 :]))
            try:
                found = read_rig_files(inputs, chosen.name, given)[1].rig
            except LabcalError:
                continue
            optional = name in OPTIONAL and re.search(OPTIONAL[name], line)
            if not optional and _differ(found, meant):
                taken.append(f"{file}: {line!r}")
        (tmp_path / file).write_bytes(content)
    assert not taken, "\n".join(taken)


def _differ(found: Rig, meant: list[Stated]) -> bool:
    """Tell whether a rig is not what was written."""
    read = [
        stated_camera((one.K[0][0], one.K[1][1], one.K[0][2], one.K[1][2]), one.dist,
                      np.array(one.T_cam_world), one.size)
        for one in found.cameras.values()
    ]  # fmt: skip
    return len(read) != len(meant) or any(a.differences(b) for a, b in zip(read, meant, strict=True))
