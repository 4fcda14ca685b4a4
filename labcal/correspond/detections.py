"""The dots of many pictures in one table."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Bool, Float64, Int64

from labcal.arrays import AnyArray, float_array, text_array, truth_array, whole_array
from labcal.correspond.table_lines import PictureLines
from labcal.detect.flags import DotFlag
from labcal.errors import InputError, UnknownNameError
from labcal.paths import AnyPath
from labcal.public_object import HtmlTable
from labcal.wording import listed

if TYPE_CHECKING:
    import matplotlib.figure
    import pandas
    import xarray


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Detections(PictureLines):
    """Dots of many pictures, a line each, in columns of equal length.

    Columns may be given as anything that NumPy takes. Two tables are equal where all their lines are, in
    their order.

    Raises
    ------
    InputError, InputTypeError
        A column has another length or shape than its lines need, or elements of another type.

    Examples
    --------
    >>> from labcal import examples
    >>> table = examples.detections()
    >>> table
    Detections(views=8, cameras=['left', 'right'], dots=1408, ok=1408)
    >>> table.where(table.view == "hand-0").picture_size("left")
    (640, 480)
    """

    image: np.ndarray
    """(n,) of str, the path as given."""
    size: Int64[np.ndarray, "n 2"]
    """Width and height of the picture, px."""
    index: Int64[np.ndarray, "n 2"]
    """(col, row), which mean something only where `has_id`."""
    has_id: Bool[np.ndarray, " n"]
    position: Float64[np.ndarray, "n 2"]
    """Centre of area of the outer outline, px; NaN where not measured."""
    covariance: Float64[np.ndarray, "n 2 2"]
    """Of `position`, px squared."""
    flag: np.ndarray
    """(n,) of str, a :class:`DotFlag`."""
    board: np.ndarray
    """(n,) of str, the board that `index` is of where pictures show several; empty where they show one."""

    def __init__(  # noqa: PLR0913, PLR0917 -- as many as columns
        self,
        view: AnyArray,
        camera: AnyArray,
        image: AnyArray,
        size: AnyArray,
        index: AnyArray,
        has_id: AnyArray,
        position: AnyArray,
        covariance: AnyArray,
        flag: AnyArray,
        board: AnyArray | None = None,
    ) -> None:
        n = np.shape(np.asarray(view))[:1]
        board = np.full(n, "") if board is None else board
        texts = {"view": view, "camera": camera, "image": image, "flag": flag, "board": board}
        whole = {"size": size, "index": index}
        self._keep(
            {
                **{name: text_array(given, n, name) for name, given in texts.items()},
                **{name: whole_array(given, (*n, 2), name) for name, given in whole.items()},
                "has_id": truth_array(has_id, n, "has_id"),
                "position": float_array(position, (*n, 2), "position"),
                "covariance": float_array(covariance, (*n, 2, 2), "covariance"),
            }
        )

    @property
    def ok(self) -> Bool[np.ndarray, " n"]:
        """The dots that are measurements of the declared grid."""
        return np.asarray(self.flag == DotFlag.OK.value)

    @cached_property
    def boards(self) -> tuple[str, ...]:
        """Names of the boards, in order of appearance; nothing where pictures show one target."""
        return tuple(name for name in dict.fromkeys(self.board.tolist()) if name)

    def measured(self) -> "Detections":
        """Return the dots that are measurements of the declared grid.

        Raises
        ------
        InputError
            One has no position, or is listed twice for a picture; or they are of several boards, of which
            :func:`~labcal.correspond.boards_table.on_target` makes dots of one target.
        """
        self.require_one_board()
        usable = self.where(self.ok)
        lost = np.flatnonzero(~np.isfinite(usable.position).all(axis=1))
        if len(lost):
            raise InputError(
                f"{usable.words(int(lost[0]))} is flagged 'ok', but has no position. Flag it otherwise."
            )
        dot = np.column_stack([usable.camera_number, usable.view_number, usable.index])
        _, first = np.unique(dot, axis=0, return_index=True)
        if len(first) < len(dot):
            twice = np.setdiff1d(np.arange(len(dot)), first)[0]
            raise InputError(
                f"{usable.words(int(twice))} is listed twice. Keep one line for each dot of a picture."
            )
        return usable

    def require_one_board(self) -> None:
        """Raise where dots are of boards by name, whose columns and rows are no target's.

        Raises
        ------
        InputError
            They are; :func:`~labcal.correspond.boards_table.on_target` makes dots of one target of them.
        """
        if self.boards:
            raise InputError(
                f"The table holds dots of boards by name ({listed(self.boards)}), but this takes those of "
                "one target. Name one of the boards as the target; or, for several, those that 'calibrate', "
                "'check', 'reconstruct' and 'evaluate' take: `target=['A', 'B']`."
            )

    @classmethod
    def load(cls, path: AnyPath) -> "Detections":
        """Read ``detections.csv``; as :func:`labcal.read_detections`, which lists its errors."""
        from labcal.correspond.detections_csv import read_detections  # noqa: PLC0415 -- it makes this class

        return read_detections(path)

    def save(self, path: AnyPath, *, force: bool = False) -> None:
        """Write ``detections.csv``; as :func:`labcal.write_detections`, which lists its errors.

        Examples
        --------
        >>> import tempfile
        >>> from labcal import Detections, examples
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     examples.detections().save(f"{folder}/detections.csv")
        ...     Detections.load(f"{folder}/detections.csv") == examples.detections()
        True
        """
        from labcal.correspond.detections_csv import write_detections  # noqa: PLC0415 -- as above

        write_detections(path, self, force=force)

    def to_pandas(self) -> "pandas.DataFrame":
        """Return the table with the columns of ``detections.csv``; col and row are ``NA`` without an id.

        Raises
        ------
        DeviceError
            pandas is not installed.

        Examples
        --------
        >>> from labcal import examples
        >>> examples.detections().to_pandas().groupby("camera")["x_px"].count().tolist()
        [704, 704]
        """
        from labcal.correspond.detection_dataframes import detections_frame  # noqa: PLC0415 -- pandas is optional

        return detections_frame(self)

    def to_xarray(self) -> "xarray.Dataset":
        """Return the dots that have an id as arrays of dimensions view, camera, dot and coordinate.

        Elements without a line of the table are NaN, with an empty flag. How many dots have no id, and are
        therefore left out, is the attribute ``dots_without_id``.

        Raises
        ------
        InputError
            A dot is listed twice for a picture.
        DeviceError
            xarray is not installed.

        Examples
        --------
        >>> from labcal import examples
        >>> dict(examples.detections().to_xarray()["position"].sizes)
        {'view': 8, 'camera': 2, 'dot': 88, 'coordinate': 2}
        """
        from labcal.correspond.detection_dataframes import (  # noqa: PLC0415 -- xarray is optional
            detections_dataset,
        )

        return detections_dataset(self)

    def plot(self, view: str | None = None, camera: str | None = None) -> "matplotlib.figure.Figure":
        """Draw where the dots are in the pictures, coloured by flag.

        Parameters
        ----------
        view, camera : str, optional
            Of this view, or camera, only. Of one picture the 95% confidence ellipses are drawn too, enlarged
            by the factor that the figure states; of several, how they are covered.

        Raises
        ------
        InputError
            There is no such picture.

        Examples
        --------
        >>> from labcal import examples
        >>> figure = examples.detections().plot("hand-0", "left")
        >>> figure.axes[0].get_xlabel()
        'x (px)'
        """
        from labcal.correspond.detections_figure import (  # noqa: PLC0415 -- imports matplotlib
            detections_figure,
        )

        return detections_figure(self, view, camera)

    def _summary(self) -> Mapping[str, object]:
        boards = {"boards": list(self.boards)} if self.boards else {}
        dots = int(self.has_id.sum())
        spots = {"without_id": len(self) - dots} if dots < len(self) else {}
        return {
            "views": len(self.views),
            "cameras": list(self.cameras),
            **boards,
            "dots": dots,
            "ok": int(self.ok.sum()),
            **spots,
        }

    def _html_tables(self) -> Sequence[HtmlTable]:
        flags = list(dict.fromkeys(self.flag.tolist()))
        counts = Counter(zip(self.camera.tolist(), self.flag.tolist(), strict=True))
        rows = [[name, *(str(counts[name, flag]) for flag in flags)] for name in self.cameras]
        return [HtmlTable(("camera", *flags), rows)]

    def words(self, line: int) -> str:
        """Return which dot a line is, for people."""
        col, row = self.index[line]
        of = f" of board '{self.board[line]}'" if self.board[line] else ""
        return f"Dot ({col}, {row}){of} in view '{self.view[line]}' of camera '{self.camera[line]}'"

    def picture_size(self, camera: str) -> tuple[int, int]:
        """Return a camera's picture size.

        Raises
        ------
        UnknownNameError
            There is no dot of such a camera.
        InputError
            Its pictures differ in size.
        """
        if camera not in self.cameras:
            raise UnknownNameError("camera in the detections", camera, self.cameras)
        sizes = np.unique(self.size[self.camera == camera], axis=0)
        if len(sizes) != 1:
            listed = ", ".join(f"{w} x {h}" for w, h in sizes)
            raise InputError(
                f"The pictures of camera '{camera}' differ in size ({listed}), but a camera takes one size. "
                "Distinguish cameras with `cameras`, or leave the other pictures out."
            )
        return (int(sizes[0, 0]), int(sizes[0, 1]))
