"""``displacements.csv``: its columns, as text, as a file and as a table of pandas."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from labcal.correspond.points_csv import UPPER
from labcal.extras import optional_module
from labcal.paths import AnyPath, as_path
from labcal.reconstruct.displacements import Displacements
from labcal.run.file_kinds import beginning_with
from labcal.run.outputs import write_file
from labcal.run.tables import columns_text

if TYPE_CHECKING:
    import pandas

HEADER = (
    "view", "point", "dX_mm", "dY_mm", "dZ_mm",
    "cov_xx", "cov_xy", "cov_xz", "cov_yy", "cov_yz", "cov_zz", "flag",
)  # fmt: skip
KIND = beginning_with("a table of displacements", f"{','.join(HEADER)}\n".encode())
_BLOCK = 2**14


def displacements_csv(found: Displacements) -> str:
    """Return the text of ``displacements.csv``; figures are written so that they read back exactly."""
    return columns_text(HEADER, _parts(found))


def write_displacements(path: AnyPath, found: Displacements, *, force: bool = False) -> None:
    """Write displacements; as :meth:`Displacements.save`, which lists its errors."""
    write_file(as_path(path), displacements_csv(found), kind=KIND, force=force)


def displacements_frame(found: Displacements) -> "pandas.DataFrame":
    """Return the columns of ``displacements.csv``; see :meth:`Displacements.to_pandas`."""
    upper = found.covariance[:, UPPER[0], UPPER[1]]
    columns = (found.view, found.name, *found.displacement.T, *upper.T, found.flag)
    frame: pandas.DataFrame = optional_module("pandas", "data").DataFrame(
        dict(zip(HEADER, columns, strict=True))
    )
    return frame


def _parts(found: Displacements) -> Iterator[list[list[object] | np.ndarray]]:
    """Yield the columns of some lines of the table after the others."""
    for first in range(0, len(found), _BLOCK):
        part = slice(first, first + _BLOCK)
        upper = found.covariance[part][:, UPPER[0], UPPER[1]]
        figures = np.column_stack([found.displacement[part], upper])
        names = (found.view[part].tolist(), found.name[part].tolist())
        yield [*names, *figures.T, found.flag[part].tolist()]
