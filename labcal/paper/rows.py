"""The 22 rows that the paper reports (tables 1 to 3), with its contradictions.

The paper's page of this project, docs/explanation/reproduction.md, says how each was read.
"""

from dataclasses import dataclass
from enum import StrEnum

from labcal.errors import InputError, UnknownNameError


class Solver(StrEnum):
    """The two solvers of the paper."""

    NETWORK = "NN"
    LEAST_SQUARES = "LS"


class Data(StrEnum):
    """The source of the points of a row."""

    PLANE = "simulated, plane"
    OTHER_PLANE = "simulated, another plane"
    FOCAL_LENGTHS = "simulated, plane, two camera models"
    VOLUME_RANDOM = "simulated, volume, random"
    VOLUME = "simulated, volume"
    WEBCAM_PLANE = "webcam pictures, plane"
    STILL_PLANE = "still camera pictures, plane"
    WEBCAM_VOLUME = "webcam pictures, four planes"
    STILL_POSITIONS = "still camera pictures, five positions"


SCENES: dict[Data, str] = {
    Data.WEBCAM_PLANE: "webcam-plane",
    Data.STILL_PLANE: "still-plane",
    Data.WEBCAM_VOLUME: "webcam-volume",
    Data.STILL_POSITIONS: "still-positions",
}
"""The rendered shoot that stands in for the paper's hardware."""


@dataclass(frozen=True)
class PaperRow:
    """One row as printed in the paper, and its settings here."""

    exp: str
    solver: Solver
    data: Data
    points: int
    paper_abs_m: float
    """The paper's "absolute error", a mean with a sign, m."""
    paper_rel: float
    """The paper's "relative error", as a fraction."""
    hidden: tuple[int, ...] = ()
    """Neurons of the hidden layers; empty for least squares."""
    goal: float | None = None
    paper_epochs: int | None = None
    noisy: bool = False
    """True if 5% Gaussian error is added to image coordinates."""
    contradiction: str | None = None
    """The contradiction within the paper that concerns the row."""

    @property
    def pictured(self) -> bool:
        """True if the row comes from pictures."""
        return self.data in SCENES


_NN, _LS = Solver.NETWORK, Solver.LEAST_SQUARES
_DEEP, _WIDE = (20, 30), (50,)
_BOARD = "absolute over relative error implies coordinates of {} m on a board about 1 m away"

ROWS: tuple[PaperRow, ...] = (
    PaperRow("01", _NN, Data.PLANE, 300, 0.00000, 0.0, _DEEP, 1e-7, 7),
    PaperRow("02", _NN, Data.PLANE, 300, 0.00001, 0.0, _DEEP, 1e-7, 9),
    PaperRow("03", _NN, Data.PLANE, 250, 0.00213, 0.002, _DEEP, 1e-6, 252, noisy=True),
    PaperRow("04", _NN, Data.PLANE, 250, 0.00091, 0.001, _DEEP, 1e-7, 989, noisy=True),
    PaperRow("05", _LS, Data.PLANE, 150, -0.00678, -0.008, noisy=True),
    PaperRow("06", _NN, Data.FOCAL_LENGTHS, 200, -0.00011, 0.0, _DEEP, 1e-8, 43),
    PaperRow(
        "07", _NN, Data.OTHER_PLANE, 250, -0.33330, 0.0, _DEEP, 1e-6, 7,
        contradiction="prints -0.33330 m with a relative error of 0%",
    ),
    PaperRow("08", _NN, Data.OTHER_PLANE, 250, 0.00010, 0.0, _DEEP, 1e-7, 9),
    PaperRow("09", _NN, Data.OTHER_PLANE, 250, 0.00025, 0.0, _DEEP, 1e-8, 12),
    PaperRow("10", _LS, Data.VOLUME_RANDOM, 100, 0.01169, 0.012),
    PaperRow("11", _LS, Data.VOLUME, 200, -0.00267, -0.003),
    PaperRow("12", _LS, Data.VOLUME, 300, 0.00076, 0.001),
    PaperRow("13", _NN, Data.VOLUME_RANDOM, 300, 0.00117, 0.001, _DEEP, 1e-7, 10),
    PaperRow("14", _NN, Data.VOLUME, 100, -0.00024, 0.0, _DEEP, 1e-8, 8),
    PaperRow("15", _NN, Data.VOLUME, 300, 0.00000, 0.0, _DEEP, 1e-8, 13),
    PaperRow(
        "17", _LS, Data.WEBCAM_PLANE, 130, 0.23590, 0.04,
        contradiction=_BOARD.format("5.9") + "; the text calls it experiment 16",
    ),
    PaperRow(
        "18", _NN, Data.WEBCAM_PLANE, 130, 0.20560, 0.05, _DEEP, 1e-8, 130,
        contradiction=_BOARD.format("4.1") + "; the text calls it experiment 17",
    ),
    PaperRow(
        "19", _LS, Data.STILL_PLANE, 130, -0.03695, 0.01,
        contradiction="its two columns have opposite signs",
    ),
    PaperRow(
        "20", _NN, Data.STILL_PLANE, 130, -0.28720, -0.02, _WIDE, 1e-6, 358,
        contradiction=_BOARD.format("14") + "; the text says surfaces were trained to 1e-7 and 1e-8",
    ),
    PaperRow("21", _NN, Data.STILL_PLANE, 130, -0.01500, -0.04, _WIDE, 1e-8, 1359),
    PaperRow("22", _NN, Data.WEBCAM_VOLUME, 520, 0.01895, 0.01, (55,), 1e-5, 5000),
    PaperRow("23", _NN, Data.STILL_POSITIONS, 130, 0.02560, 0.015, (55,), 1e-6, 1256),
)  # fmt: skip

NOT_REPORTED: tuple[str, ...] = ("16",)
"""Named in the paper's text, absent from its tables."""


def row_named(exp: str) -> PaperRow:
    """Return a row by its number, with or without the leading zero.

    Raises
    ------
    UnknownNameError
        The paper has no such row.
    InputError
        The paper has it in its text only.
    """
    known = {row.exp: row for row in ROWS}
    if exp.zfill(2) in NOT_REPORTED:
        raise InputError(f"The paper names experiment {exp} in its text, but reports no figures of it.")
    if exp.zfill(2) not in known:
        raise UnknownNameError("row of the paper", exp, known)
    return known[exp.zfill(2)]
