"""The protocol of lens models, and the models by name."""

from typing import Protocol, runtime_checkable

import numpy as np

from labcal.cameras.double_sphere import DoubleSphere
from labcal.cameras.enhanced_unified import EnhancedUnified
from labcal.cameras.field import Direction, FallOff, FieldPoint, SceneRay
from labcal.cameras.fisheye import KannalaBrandt
from labcal.cameras.lens_trial import require_working
from labcal.cameras.mathematics import Mathematics, Number
from labcal.cameras.omnidirectional import Omnidirectional
from labcal.cameras.opencv_model import OpenCVModel
from labcal.cameras.perspective import Perspective
from labcal.cameras.telecentric import Telecentric
from labcal.errors import InputError, InputTypeError, UnknownNameError
from labcal.run.registration import require_members, require_own_name

LENGTH = 5
"""OpenCV's shortest coefficient vector that it takes everywhere."""
MOST_COEFFICIENTS = 14
"""Of any lens model."""
FISHEYE = "fisheye-kb4"
"""The lens model that images directions far from its axis."""
DOUBLE_SPHERE, ENHANCED_UNIFIED, OMNIDIRECTIONAL = "double-sphere", "eucm", "omni-radtan"
"""Lens models of the robotics community, which see more than 180 degrees by closed formulas."""
TELECENTRIC = "telecentric"
"""The lens model whose rays are parallel."""
PRESCRIPTION = "prescription"
"""The lens model whose rays are traced through a prescription; it has no entry of its own in LENSES."""
_TAKEN = (PRESCRIPTION, "auto")
"""Names that mean something else in the place of a lens model's."""


@runtime_checkable  # so that tests can check annotations
class Lens(Protocol):
    """A lens model: closed formulas from a field point to the picture and to a ray, and their inverses.

    Formulas are written on separate components with plain operators. Every method takes the lens's
    parameters, because the renderer passes its own kind of number, and derivatives pass dual ones.

    What others need to know of it, file formats, the renderer and initial values, a lens declares; where it
    has no answer they refuse it by name and never take it for another one.
    """

    @property
    def name(self) -> str:
        """The name in files and on the command line."""

    @property
    def coefficients(self) -> int:
        """Number of free coefficients."""

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the coefficients, in the order of `dist`."""

    @property
    def opencv(self) -> OpenCVModel | None:
        """The model of OpenCV whose coefficients these are, by name; None where it is none of OpenCV's."""

    @property
    def undistorted(self) -> tuple[float, ...]:
        """Initial values and prior means of the coefficients: those of no distortion, or typical ones."""

    @property
    def ranges(self) -> tuple[tuple[float, float], ...] | None:
        """The least and the greatest value of each coefficient that makes sense.

        None where that depends on the radius, as of the coefficients of a polynomial.
        """

    @property
    def fall_off(self) -> FallOff | None:
        """Fall-off of its light; None if it is not known."""

    @property
    def rectilinear(self) -> bool:
        """True if it images straight lines straight without distortion, hence less than 180 degrees."""

    @property
    def central(self) -> bool:
        """True if all rays pass the origin of the camera's frame."""

    @property
    def parallel(self) -> bool:
        """True if all rays are parallel to the axis.

        Then :meth:`field_point` takes a point in mm, `fx` and `fy` are px/mm, and depth is not to be seen.
        The principal point is only where distortion is counted from, and is not estimated.
        """

    def formula(self, m: Mathematics, dist: tuple[Number, ...]) -> tuple[Number, ...]:
        """Return the leading :meth:`parameters`, all that :meth:`distort` takes, from the coefficients."""

    def forward_parameters(self, m: Mathematics, dist: tuple[float, ...]) -> tuple[float, ...]:
        """Return the leading :meth:`parameters`, without what only :meth:`undistort` takes.

        They cost a hundredth: the guess of an inverse is fitted.
        """

    def parameters(self, m: Mathematics, dist: tuple[float, ...], reach: float) -> tuple[float, ...]:
        """Return all parameters; `reach` is the largest radius of the picture at unit focal length."""

    def undistorted_radius(self, angle: float) -> float:
        """Return the radius at which an angle (rad) is imaged with these coefficients (unit focal length)."""

    def distort(
        self, m: Mathematics, parameters: tuple[Number, ...], a: Number, b: Number
    ) -> tuple[Number, Number]:
        """Return the normalised image coordinates (x, y) of a field point."""

    def field_point(self, m: Mathematics, parameters: tuple[Number, ...], direction: Direction) -> FieldPoint:
        """Return the field point of a direction of any length; of a lens that is not central, roughly."""

    def undistort(self, m: Mathematics, parameters: tuple[Number, ...], x: Number, y: Number) -> FieldPoint:
        """Return the field point of normalised image coordinates (x, y); not ok if there is none."""

    def is_imaged(self, parameters: tuple[Number, ...], a: Number, b: Number) -> Number:
        """Return whether the lens images a field point: short of its fold, and past every surface."""

    def chief_ray(self, m: Mathematics, parameters: tuple[Number, ...], a: Number, b: Number) -> SceneRay:
        """Return the chief ray of a field point, in the camera's frame, out into the scene."""


LENSES: dict[str, Lens] = {
    lens.name: lens
    for lens in (
        Perspective("pinhole", 0),
        Perspective("brown-k1k2", 2),
        Perspective("brown5", 5),
        Perspective("rational8", 8),
        Perspective("thin-prism12", 12),
        Perspective("tilted14", 14),
        KannalaBrandt(FISHEYE),
        DoubleSphere(DOUBLE_SPHERE),
        EnhancedUnified(ENHANCED_UNIFIED),
        Omnidirectional(OMNIDIRECTIONAL),
        Telecentric(TELECENTRIC, 5),
    )
}


def undistorted_dist(lens: Lens) -> np.ndarray:
    """Return `dist` of the lens without distortion, padded with zeros, shape (max(5, coefficients),)."""
    dist = np.zeros(max(LENGTH, lens.coefficients))
    dist[: lens.coefficients] = lens.undistorted
    return dist


def lens_by_name(name: str) -> Lens:
    """Return the lens model of that name.

    Raises
    ------
    UnknownNameError
        There is none; the nearest name is offered.
    """
    if name not in LENSES:
        raise UnknownNameError("lens model", name, [*LENSES, PRESCRIPTION])
    return LENSES[name]


_SHIPPED = frozenset(LENSES)


def register_lens(lens: Lens) -> Lens:
    """Add a lens model of one's own, which is then found by its name wherever labcal's are.

    It is known in the process that registers it. Workers of a script import its module anew, so that what
    stands there outside ``if __name__ == "__main__":`` registers it in them, too.

    Parameters
    ----------
    lens : Lens
        One that was registered under the same name before is replaced, as when a cell of a notebook is run
        again.

    Raises
    ------
    InputTypeError
        It is a class, or lacks something that a lens model has.
    InputError
        Its name is that of a lens of labcal, capital letters apart, or no name; it has too many coefficients,
        or not as many names as coefficients; or one of its parts fails on directions near the axis: it raises
        an error, returns no numbers, does not lead back, or has wrong derivatives.
    """
    if isinstance(lens, type):
        raise InputTypeError(
            f"A lens model is an object, but {lens.__name__} is a class. Give an object of it."
        )
    require_members(f"An object of the class '{type(lens).__name__}' is no lens model", lens, (Lens,))
    require_own_name("lens", lens.name, (*_SHIPPED, *_TAKEN), LENSES.keys() - _SHIPPED)
    names, count = lens.names, lens.coefficients
    named = isinstance(names, tuple) and all(isinstance(name, str) for name in names)
    if not (named and type(count) is int and len(names) == len(set(names)) == count <= MOST_COEFFICIENTS):
        raise InputError(
            f"The lens '{lens.name}' has {count!r:.20} coefficients with the names {names!r:.200}. It should "
            f"have up to {MOST_COEFFICIENTS}, each with a name of its own, in a tuple."
        )
    require_working(lens, MOST_COEFFICIENTS)
    LENSES[lens.name] = lens
    return lens
