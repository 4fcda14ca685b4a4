"""Several boards side by side as one target: fixed to one plate, or moved each by itself."""

from collections.abc import Callable
from enum import StrEnum
from functools import cached_property
from typing import Annotated, Any, Literal

import numpy as np
from jaxtyping import Float64, Int64
from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    PlainSerializer,
    model_serializer,
    model_validator,
)

from labcal.arrays import DotIndices, Lengths, Pose, Vectors3
from labcal.bounds import MOST_DOTS, Amount, Finite, Margin
from labcal.errors import InputError
from labcal.geometry.poses import require_rigid, transform
from labcal.run.names import Name, differ_in_case
from labcal.targets.same_looking import why_same_looking
from labcal.targets.target import PrintableTarget
from labcal.wording import listed

_GAP_SHARE = 0.1
"""Between boards that are laid out side by side, of the widest one's width."""
_Row = tuple[Finite, Finite, Finite, Finite]
_Triple = tuple[Amount, Amount, Amount]


def _described(value: object) -> object:
    """Return the target of a description, a name or a path in the list of boards."""
    from labcal.targets.catalogue import described_target  # noqa: PLC0415 -- it reads this kind, too

    return described_target(value)


def _by_its_own_model(target: PrintableTarget) -> object:
    return target.model_dump(mode="json")


Board = Annotated[Any, BeforeValidator(_described), PlainSerializer(_by_its_own_model)]
"""A target of any other kind."""


class Mounting(StrEnum):
    """Motion of boards between views."""

    RIGID = "rigid"
    """Fixed to one plate: their relative poses are the same in all views."""
    SEPARATE = "separate"
    """Each moves by itself: a picture of each is a view of its own."""


class BoardPlace(BaseModel):
    """Pose of a board in the set's frame, which is that of the first board."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    T_set_board: tuple[_Row, _Row, _Row, _Row]
    """Rigid transform from the board's frame to that of the first board; mm."""
    sigma_rotation_rad: _Triple | None = None
    """Standard deviations of its rotation about the first board's axes; left out where it is known."""
    sigma_mm: _Triple | None = None
    """Standard deviations of the place of the board's origin along the same axes; likewise."""

    @model_serializer(mode="wrap")
    def _without_what_is_not_there(self, dump: Callable[[Any], dict[str, Any]]) -> dict[str, Any]:
        return {key: value for key, value in dump(self).items() if value is not None}

    @property
    def T(self) -> Pose:
        """The transform as an array."""
        return np.array(self.T_set_board, dtype=np.float64)


class BoardSet(BaseModel):
    """Boards that pictures show side by side, each with a name.

    As one target its dots are numbered one after the other, board by board, in a single row: dot (n, 0).
    Tables keep each board's own columns and rows beside its name. The frame is that of the first board.
    Lengths are in millimetres.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    kind: Literal["boards"] = "boards"
    """Kind of the target."""
    name: Name
    """Name of the set: letters, digits and hyphens."""
    description: str = ""
    """Description of the set, for people."""
    targets: Annotated[tuple[Board, ...], Field(min_length=2, max_length=20)]
    """Boards: names of targets, paths of their files, or whole descriptions, each with another name."""
    mounting: Mounting = Mounting.RIGID
    """Fixed to one plate (`rigid`), or moved each by itself (`separate`)."""
    places: tuple[BoardPlace, ...] | None = None
    """Poses of the boards on the plate, in their order; left out where they are to be found."""

    @model_serializer(mode="wrap")
    def _without_what_is_not_there(self, dump: Callable[[Any], dict[str, Any]]) -> dict[str, Any]:
        return {key: value for key, value in dump(self).items() if key != "places" or value is not None}

    @model_validator(mode="after")
    def _fits_together(self) -> "BoardSet":
        names = [board.name for board in self.targets]
        alike = differ_in_case(names)
        if len(set(names)) < len(names) or alike is not None:
            raise ValueError(f"targets: boards need names that differ, but these are {listed(names)}")
        for board in self.targets:
            if isinstance(board, BoardSet):
                raise ValueError(f"targets: '{board.name}' is a set of boards; name the boards in it")  # noqa: TRY004
            if board.symmetric_indices(board.indices()[:1]):
                raise ValueError(
                    f"targets: '{board.name}' looks the same when turned; beside others each board needs "
                    "rings, marks or codes that number it"
                )
        if self.count > MOST_DOTS:
            raise ValueError(f"targets: the boards have more than {MOST_DOTS} dots together")
        for number, board in enumerate(self.targets):
            for other in self.targets[number + 1 :]:
                if why := why_same_looking(board, other):
                    raise ValueError(
                        f"targets: '{board.name}' and '{other.name}' cannot be distinguished: {why}"
                    )
        self._check_places()
        return self

    def _check_places(self) -> None:
        if self.places is None:
            return
        if self.mounting is Mounting.SEPARATE:
            raise ValueError("places: boards that move separately have no fixed places; leave them out")
        if len(self.places) != len(self.targets):
            raise ValueError(f"places: {len(self.places)} are stated for {len(self.targets)} boards")
        for board, place in zip(self.targets, self.places, strict=True):
            try:
                require_rigid(place.T, f"the place of '{board.name}'")
            except InputError as error:
                raise ValueError(f"places: {error}") from error
        if not np.array_equal(self.places[0].T, np.eye(4)):
            raise ValueError("places: the first board's is the frame of all, so it is the unit matrix")

    @cached_property
    def spans(self) -> tuple[slice, ...]:
        """Numbers of each board's dots in the set."""
        ends = np.cumsum([board.count for board in self.targets]).tolist()
        return tuple(slice(a, b) for a, b in zip([0, *ends[:-1]], ends, strict=True))

    @cached_property
    def board_number(self) -> Int64[np.ndarray, " count"]:
        """Of each dot of the set, the place of its board in the list."""
        return np.repeat(np.arange(len(self.targets)), [board.count for board in self.targets])

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the boards."""
        return tuple(board.name for board in self.targets)

    def board_of_name(self, name: str) -> PrintableTarget:
        """Return the board of a name, which is one of :attr:`names`."""
        found: PrintableTarget = self.targets[self.names.index(name)]
        return found

    @property
    def poses(self) -> Float64[np.ndarray, "boards 4 4"]:
        """``T_set_board`` of each board, mm: as stated, or laid out side by side where none are."""
        if self.places is not None:
            return np.stack([place.T for place in self.places])
        T = np.tile(np.eye(4), (len(self.targets), 1, 1))
        extents = [board.extent_mm for board in self.targets]
        gap = _GAP_SHARE * max(x_max - x_min for x_min, _, x_max, _ in extents)
        for number in range(1, len(extents)):
            T[number, 0, 3] = T[number - 1, 0, 3] + extents[number - 1][2] + gap - extents[number][0]
        return T

    def placed(self, poses: Float64[np.ndarray, "boards 4 4"]) -> "BoardSet":
        """Return the same boards at other places, ``T_set_board``, mm."""
        places = tuple(BoardPlace(T_set_board=tuple(tuple(row) for row in T)) for T in poses.tolist())
        return self.model_copy(update={"places": places})

    def with_sigmas(self, sigmas: Float64[np.ndarray, "boards 6"]) -> "BoardSet":
        """Return the same places with standard deviations: rotations (rad), then origins (mm); not of NaN."""
        places = tuple(
            place.model_copy(update={"sigma_rotation_rad": tuple(sigma[:3]), "sigma_mm": tuple(sigma[3:])})
            if number and np.isfinite(sigma).all()
            else place
            for number, (place, sigma) in enumerate(zip(self.places or (), sigmas.tolist(), strict=True))
        )
        return self.model_copy(update={"places": places})

    def own_indices(self) -> DotIndices:
        """Return (col, row) of every dot on its own board, shape (count, 2)."""
        return np.concatenate([board.indices() for board in self.targets])

    @property
    def cols(self) -> int:
        """Dots of all boards, which are numbered in one row."""
        return self.count

    @property
    def rows(self) -> int:
        """One."""
        return 1

    @property
    def count(self) -> int:
        """Number of dots of all boards."""
        return sum(board.count for board in self.targets)

    @property
    def extent_mm(self) -> tuple[float, float, float, float]:
        """Edges of the plate that holds all boards, as far as they lie in the first one's plane."""
        corners = []
        for board, T in zip(self.targets, self.poses, strict=True):
            x_min, y_min, x_max, y_max = board.extent_mm
            flat = np.array([[x, y, 0.0] for x in (x_min, x_max) for y in (y_min, y_max)])
            corners.append(transform(T, flat)[:, :2])
        every = np.concatenate(corners)
        (x_min, y_min), (x_max, y_max) = every.min(axis=0).tolist(), every.max(axis=0).tolist()
        return x_min, y_min, x_max, y_max

    @property
    def margin_mm(self) -> Margin:
        """0: the boards' own margins count."""
        return 0.0

    @property
    def least_margin_mm(self) -> float:
        """0: likewise."""
        return 0.0

    @property
    def place_name(self) -> str:
        """A dot, or a corner where all boards have corners."""
        kinds = {board.place_name for board in self.targets}
        return str(kinds.pop()) if len(kinds) == 1 else "dot"

    @property
    def is_white_on_black(self) -> bool:
        """True if all boards are printed white on black."""
        return all(board.is_white_on_black for board in self.targets)

    @property
    def captions(self) -> tuple[str, str]:
        """Names of the boards; their mounting."""
        how = "on one plate" if self.mounting is Mounting.RIGID else "each moved by itself"
        return f"{self.name}: {listed(self.names)}", f"{len(self.targets)} boards, {how}"

    @property
    def sizes(self) -> tuple[str, str]:
        """Pitches of the boards; sizes of their dots."""
        pitches, dots = zip(*(board.sizes for board in self.targets), strict=True)
        return ", ".join(dict.fromkeys(pitches)), ", ".join(dict.fromkeys(dots))

    def indices(self) -> DotIndices:
        """Return (n, 0) for each dot, shape (count, 2), integer."""
        return np.stack([np.arange(self.count), np.zeros(self.count, dtype=np.int64)], axis=-1)

    def points(self, indices: DotIndices | None = None) -> Vectors3:
        """Return the places of dots (n, 2), or of all, in the frame of the first board, mm, shape (n, 3).

        Boards whose places are not stated lie side by side in one plane.
        """
        whole = [transform(T, board.points()) for board, T in zip(self.targets, self.poses, strict=True)]
        every = np.concatenate(whole)
        return every if indices is None else every[indices[:, 0]]

    def outer_diameters_mm(self) -> Lengths:
        """Return every dot's outer diameter in mm, board by board; 0 for a corner."""
        return np.concatenate([board.outer_diameters_mm() for board in self.targets])

    def symmetric_indices(self, indices: DotIndices) -> tuple[DotIndices, ...]:  # noqa: ARG002 -- as of every target
        """Return nothing: a board that looks the same when turned is refused."""
        return ()
