"""Trial of a user's lens model when it is registered: what it declares, its formulas and their derivatives.

A lens that passes is the same in both directions near its axis, with its undistorted coefficients, and
differentiable there. What it does farther out is for its own tests.
"""

from collections.abc import Callable
from math import isfinite
from numbers import Real
from typing import TYPE_CHECKING

import numpy as np

from labcal.cameras.dual import Dual, DualMathematics, constants, variables
from labcal.cameras.field import FallOff, FieldPoint, SceneRay
from labcal.cameras.mathematics import NUMPY, Number
from labcal.cameras.opencv_model import OpenCVModel
from labcal.errors import InputError
from labcal.run.user_code import user_code
from labcal.wording import counted

if TYPE_CHECKING:
    from labcal.cameras.lens import Lens

_X = np.array([0.0, 0.06, -0.04, 0.03, -0.07])
_Y = np.array([0.0, 0.02, 0.05, -0.06, -0.03])
"""Directions (x, y, 1) within some 5 degrees of the axis; of parallel rays, points in mm."""
_REACH = 0.2
_ALIKE = 1e-6
"""Difference at unit focal length up to which two ways lead to the same."""
_STEP, _ALIKE_SLOPES, _ROUNDING = 1e-6, 1e-3, 1e-9
"""Of difference quotients; their departure from slopes, of the largest one, and what rounding adds to it."""
_FIELD = 2


def require_working(lens: "Lens", most_coefficients: int) -> None:
    """Raise unless a lens model does what the protocol asks for, near its axis.

    Parameters
    ----------
    lens : Lens
        It has all members.
    most_coefficients : int
        Of any lens; coefficients are padded to so many.

    Raises
    ------
    InputError
        The first part that is not as it should be, and what it should be.
    """
    _require_declarations(lens)
    with np.errstate(all="ignore"):  # as in a camera, where what is out of the field is no number
        _require_formulas(lens, most_coefficients)


def _require_formulas(lens: "Lens", most_coefficients: int) -> None:
    """Raise unless parameters, both ways, and derivatives are those of one lens."""
    padded = (*lens.undistorted, *(0.0,) * (most_coefficients - lens.coefficients))
    formula = _parameters(lens, "formula", lambda: lens.formula(NUMPY, padded))
    forward = _parameters(lens, "forward_parameters", lambda: lens.forward_parameters(NUMPY, padded))
    _require_beginning(lens, forward, formula, ("forward_parameters", "formula"))
    whole = _parameters(lens, "parameters", lambda: lens.parameters(NUMPY, padded, _REACH))
    _require_beginning(lens, whole, forward, ("parameters", "forward_parameters"))
    field = _require_inverse(lens, forward, whole)
    _require_derivatives(lens, padded, forward, field)


def _require_declarations(lens: "Lens") -> None:
    """Raise unless the attributes are of the types, and as many, as the protocol asks for."""
    count, model, switches = lens.coefficients, lens.opencv, ("rectilinear", "central", "parallel")
    pairs = f"None, or a tuple of {counted(count, 'pair')}, least and greatest value"
    named_by_opencv = isinstance(model, OpenCVModel) and set(lens.names) <= set(model.order)
    for name, fits, wanted in (
        (
            "undistorted",
            _are_numbers(lens.undistorted, count),
            f"a tuple of {counted(count, 'finite number')}",
        ),
        ("ranges", lens.ranges is None or _are_ranges(lens.ranges, count), pairs),
        ("opencv", model is None or named_by_opencv, "None, or a model of OpenCV's with these coefficients"),
        ("fall_off", lens.fall_off is None or isinstance(lens.fall_off, FallOff), "None, or a FallOff"),
        *((name, isinstance(getattr(lens, name), bool), "True or False") for name in switches),
    ):
        if not fits:
            raise _fault(lens, name, f"is {getattr(lens, name)!r:.80}, but should be {wanted}")
    within = zip(lens.undistorted, lens.ranges or (), strict=False)
    if any(not least <= value <= most for value, (least, most) in within):
        raise _fault(lens, "undistorted", f"is {lens.undistorted!r:.80}, which is not within its ranges")


def _are_numbers(values: object, count: int) -> bool:
    """Tell whether an object is a tuple of so many finite numbers."""
    return (
        isinstance(values, tuple)
        and len(values) == count
        and all(isinstance(value, Real) and isfinite(value) for value in values)
    )


def _are_ranges(ranges: object, count: int) -> bool:
    """Tell whether an object is a tuple of so many pairs, the least value first."""
    return (
        isinstance(ranges, tuple)
        and len(ranges) == count
        and all(_are_numbers(pair, 2) and pair[0] < pair[1] for pair in ranges)
    )


def _parameters(lens: "Lens", name: str, made: Callable[[], object]) -> tuple[float, ...]:
    """Return parameters, which must be a tuple of numbers; infinity is one."""
    with user_code(_part(lens, name)):
        found = made()
        if isinstance(found, tuple) and not np.isnan(np.array(found, dtype=np.float64)).any():
            return found
    raise _fault(lens, name, f"should return a tuple of numbers, not {found!r:.80}")


def _require_beginning(
    lens: "Lens", longer: tuple[float, ...], shorter: tuple[float, ...], names: tuple[str, str]
) -> None:
    """Raise unless parameters begin with those that leave something out."""
    if longer[: len(shorter)] != shorter:
        raise _fault(lens, names[0], f"should begin with what '{names[1]}' returns")


def _require_inverse(
    lens: "Lens", forward: tuple[float, ...], whole: tuple[float, ...]
) -> tuple[np.ndarray, np.ndarray]:
    """Raise unless directions come back from the picture; return their field points."""
    ones = np.ones_like(_X)
    with user_code(_part(lens, "field_point")):
        a, b = _field(lens, "field_point", lens.field_point(NUMPY, forward, (_X, _Y, ones)))
    with user_code(_part(lens, "is_imaged")):
        imaged = lens.is_imaged(whole, a, b)
    _require_all(lens, "is_imaged", imaged)
    with user_code(_part(lens, "distort")):
        x, y = _pair(lens, "distort", lens.distort(NUMPY, forward, a, b))
    with user_code(_part(lens, "undistort")):
        back = _field(lens, "undistort", lens.undistort(NUMPY, whole, x, y))
    if max(np.abs(back[0] - a).max(), np.abs(back[1] - b).max()) > _ALIKE:
        raise _fault(lens, "undistort", "does not lead back to the field points that 'distort' was given")
    with user_code(_part(lens, "chief_ray")):
        ray = lens.chief_ray(NUMPY, whole, a, b)
    _require_ray(lens, ray)
    with user_code(_part(lens, "undistorted_radius")):
        radius = float(lens.undistorted_radius(0.1))
    if not (lens.parallel or 0.0 < radius < np.inf):
        raise _fault(lens, "undistorted_radius", f"is {radius} for 0.1 rad, but should be more than 0")
    return a, b


def _require_ray(lens: "Lens", ray: object) -> None:
    """Raise unless a chief ray is a unit vector from a point, and where it is known, the one of the trial."""
    if not isinstance(ray, SceneRay):
        raise _fault(lens, "chief_ray", f"should return a SceneRay, not {ray!r:.80}")
    _require_all(lens, "chief_ray", ray.ok)
    origin = _numbers(lens, "chief_ray", ray.origin, 3)
    direction = _numbers(lens, "chief_ray", ray.direction, 3)
    expected = np.stack([0.0 * _X, 0.0 * _X, 1.0 + 0.0 * _X] if lens.parallel else [_X, _Y, 1.0 + 0.0 * _X])
    expected /= np.linalg.norm(expected, axis=0)
    if np.abs(np.linalg.norm(direction, axis=0) - 1.0).max() > _ALIKE:
        raise _fault(lens, "chief_ray", "should return directions of length 1")
    if (lens.central or lens.parallel) and np.abs(direction - expected).max() > _ALIKE:
        raise _fault(lens, "chief_ray", "does not lead back to the directions that 'field_point' was given")
    if lens.central and np.abs(origin).max() > 0.0:
        raise _fault(lens, "chief_ray", "should begin at the origin, since the lens declares itself central")


def _require_derivatives(
    lens: "Lens",
    padded: tuple[float, ...],
    forward: tuple[float, ...],
    field: tuple[np.ndarray, np.ndarray],
) -> None:
    """Raise unless the slopes of dual numbers are the limits of difference quotients."""
    count, m = lens.coefficients, DualMathematics(NUMPY)
    width = _FIELD + count

    def image(values: list[Number]) -> tuple[np.ndarray, np.ndarray]:
        formula = lens.formula(NUMPY, (*values[_FIELD:], *padded[count:]))
        return lens.distort(NUMPY, (*formula, *forward[len(formula) :]), values[0], values[1])

    at: list[Number] = [*field, *padded[:count]]
    with user_code(_part(lens, "formula", of_duals=True)):
        varied = variables(*at)
        formula = lens.formula(m, (*varied[_FIELD:], *constants(padded[count:], width)))
    with user_code(_part(lens, "distort", of_duals=True)):
        rest = constants(forward[len(formula) :], width)
        found = lens.distort(m, (*formula, *rest), varied[0], varied[1])
    names = ("a", "b", *lens.names)
    _require_slopes(lens, "distort", found, image, (at, names, _signs(lens)))
    if not (lens.central or lens.parallel):
        return
    ones = np.ones_like(_X)
    with user_code(_part(lens, "field_point", of_duals=True)):
        X, Y, Z = variables(_X, _Y, ones)
        point = lens.field_point(m, forward, (X, Y, Z))

    def field_of(values: list[Number]) -> tuple[np.ndarray, np.ndarray]:
        one = lens.field_point(NUMPY, forward, (values[0], values[1], values[2]))
        return one.a, one.b

    where = ([_X, _Y, ones], ("X", "Y", "Z"), (1.0,) * 3)
    _require_slopes(lens, "field_point", (point.a, point.b), field_of, where)


def _signs(lens: "Lens") -> tuple[float, ...]:
    """Return the way along which each argument of the formula can be varied within its range."""
    ranges = lens.ranges or ((-np.inf, np.inf),) * lens.coefficients
    pairs = zip(lens.undistorted, ranges, strict=True)
    return (1.0, 1.0, *(1.0 if value + _STEP <= most else -1.0 for value, (_, most) in pairs))


def _require_slopes(
    lens: "Lens",
    name: str,
    found: object,
    plain: Callable[[list[Number]], tuple[np.ndarray, np.ndarray]],
    where: tuple[list[Number], tuple[str, ...], tuple[float, ...]],
) -> None:
    """Raise unless both dual numbers have the slopes of a plain function; where: arguments, names, signs."""
    if not (isinstance(found, tuple) and len(found) == 2 and all(isinstance(one, Dual) for one in found)):  # noqa: PLR2004 -- two coordinates
        raise _fault(
            lens, name, "should return two dual numbers for dual numbers, and take all functions from 'm'"
        )
    at, names, signs = where
    base = plain(at)
    for number, (argument, sign) in enumerate(zip(names, signs, strict=True)):
        moved, has_effect = list(at), False
        moved[number] = at[number] + sign * _STEP
        for one, before, after in zip(found, base, plain(moved), strict=True):
            slope = np.broadcast_to(np.asarray(one.slopes[number], dtype=np.float64), _X.shape)
            quotient = (np.asarray(after) - before) / (sign * _STEP)
            has_effect = has_effect or bool(slope.any())
            largest = max(np.abs(quotient).max(), np.abs(slope).max())
            if not (np.abs(slope - quotient) <= _ALIKE_SLOPES * largest + _ROUNDING).all():
                raise _fault(
                    lens,
                    name,
                    f"has a derivative by {argument} of {slope[-1]:.6g}, but its values change by "
                    f"{quotient[-1]:.6g}. Use plain operators, and functions of 'm'",
                )
        if not has_effect and argument in lens.names:
            raise _fault(lens, name, f"does not depend on the coefficient '{argument}'")


def _field(lens: "Lens", name: str, found: object) -> tuple[np.ndarray, np.ndarray]:
    """Return both coordinates of a field point, which must be one."""
    if not isinstance(found, FieldPoint):
        raise _fault(lens, name, f"should return a FieldPoint, not {found!r:.80}")
    _require_all(lens, name, found.ok)
    return _pair(lens, name, (found.a, found.b))


def _pair(lens: "Lens", name: str, found: object) -> tuple[np.ndarray, np.ndarray]:
    """Return two arrays of numbers, one for each direction of the trial."""
    first, second = _numbers(lens, name, found, 2)
    return first, second


def _numbers(lens: "Lens", name: str, found: object, count: int) -> np.ndarray:
    """Return so many arrays of numbers, stacked."""
    if isinstance(found, tuple) and len(found) == count:
        arrays = [np.asarray(one) for one in found]
        if all(
            one.shape == _X.shape and one.dtype == np.float64 and np.isfinite(one).all() for one in arrays
        ):
            return np.stack(arrays)
    raise _fault(
        lens,
        name,
        f"should return {count} finite float64 arrays of the shape that it is given, near the axis",
    )


def _require_all(lens: "Lens", name: str, ok: object) -> None:
    """Raise unless what is near the axis is said to be imaged."""
    mask = np.asarray(ok)
    if not (mask.shape == _X.shape and mask.dtype == np.bool_ and mask.all()):
        raise _fault(lens, name, "should state, in an array, that directions near the axis are imaged")


def _part(lens: "Lens", name: str, *, of_duals: bool = False) -> str:
    """Return the words for a part of the lens that runs."""
    given = " for dual numbers, which carry derivatives," if of_duals else ""
    return f"The lens '{lens.name}': its '{name}'{given}"


def _fault(lens: "Lens", name: str, what: str) -> InputError:
    return InputError(
        f"The lens '{lens.name}': its '{name}' {what}. The how-to guide 'Add a lens model' shows a whole one."
    )
