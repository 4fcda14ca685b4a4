"""The checker of annotations refuses what ``jaxtyping.jaxtyped`` refuses; see `annotation_checks`."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import no_type_check

import jaxtyping
import numpy as np
import pytest
from annotation_checks import EVERY, FIRST, begin_test, check_once, checked
from jaxtyping import Float64, TypeCheckError

from labcal.targets.grid import DotGrid

Vector = Float64[np.ndarray, " n"]
Checker = Callable[..., Callable[..., object]]


def total(a: Vector, b: Vector) -> Vector:
    return a + b


def first(a: Vector) -> Vector:
    return a[:1]


def ends(a: Vector) -> tuple[Float64[np.ndarray, " one"], Vector]:
    return total(a[:1], a[:1]), a  # a length of its own within


def text(number: int, *more: int, unit: str = "mm") -> str:
    return f"{number + sum(more)} {unit}" if number else None  # type: ignore[return-value]


def lengths(a: Vector) -> Iterator[Vector]:
    yield from (a[:n] for n in range(len(a)))


@dataclass(frozen=True)
class Pair:
    a: Vector
    b: Vector


@dataclass(frozen=True)
class NamedPair(Pair):
    name: str = "pair"

    def swapped(self) -> "NamedPair":
        return NamedPair(self.b, self.a, self.name)


@pytest.fixture(params=["once", "jaxtyped"])
def checker(request: pytest.FixtureRequest) -> Checker:
    """Return the checker, and jaxtyping's own, which all of this must be true of as well."""
    import annotation_checks  # noqa: PLC0415 -- what it keeps for itself

    if request.param == "once":
        return checked
    from beartype import beartype  # noqa: PLC0415 -- of this checker alone

    return lambda fn: annotation_checks._jaxtyped(fn, typechecker=beartype)


def test_lengths_of_one_name_are_equal_in_arguments_and_result(checker: Checker) -> None:
    two, three = np.zeros(2), np.zeros(3)
    assert checker(total)(two, b=two).shape == (2,)
    with pytest.raises(TypeCheckError):
        checker(total)(two, three)
    with pytest.raises(TypeCheckError):
        checker(first)(three)
    with pytest.raises(TypeCheckError):
        checker(total)(two, two.astype(np.float32))


def test_each_call_has_lengths_of_its_own(checker: Checker, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(globals(), "total", checker(total))
    one = checker(ends)
    assert [len(part) for part in one(np.zeros(3))] == [1, 3]  # type: ignore[attr-defined]
    assert [len(part) for part in one(np.zeros(4))] == [1, 4]  # type: ignore[attr-defined]
    assert [len(part) for part in checker(lengths)(np.zeros(3))] == [0, 1, 2]  # type: ignore[attr-defined]


def test_other_types_are_checked(checker: Checker) -> None:
    one = checker(text)
    assert one(1, 2, unit="m") == "3 m"
    for words, options in (((1.0,), {}), ((1, "2"), {}), ((1,), {"unit": 3}), ((0,), {})):
        with pytest.raises(TypeCheckError):
            one(*words, **options)
    with pytest.raises(TypeError, match="missing"):
        one()


def test_fields_of_dataclasses_are_checked(checker: Checker) -> None:
    class Mine(Pair):
        """With the checked ``__init__`` of another class."""

    own = dataclass(frozen=True)(type("Own", (Mine,), {"__annotations__": dict(Pair.__annotations__)}))
    one = checker(own)
    assert one(np.zeros(2), np.zeros(2)).a.shape == (2,)  # type: ignore[attr-defined]
    with pytest.raises(TypeCheckError):
        one(np.zeros(2), np.zeros(3))
    with pytest.raises(TypeCheckError):
        one(np.zeros(2), "b")


def test_names_that_are_not_known_yet_and_what_says_so_are_not_checked(checker: Checker) -> None:
    def later(value: "NotYetMade") -> "NotYetMade":  # type: ignore[name-defined]
        return value

    assert checker(later)(3) == 3

    @no_type_check
    def free(number: int) -> int:
        return number

    assert checker(free)("a") == "a"


def test_checks_can_be_switched_off(checker: Checker) -> None:
    functions = checker(total), checker(text)
    jaxtyping.config.update("jaxtyping_disable", True)
    try:
        assert functions[0](1, 2) == 3
        assert functions[1](1.5) == "1.5 mm"
    finally:
        jaxtyping.config.update("jaxtyping_disable", False)


def test_every_test_checks_the_first_calls_and_some_of_a_loop() -> None:
    two, three = np.zeros(2), np.zeros(3)
    one = checked(total)
    for _ in range(FIRST):
        with pytest.raises(TypeCheckError):
            one(two, three)
    wrong = []
    for _ in range(3 * EVERY):
        try:
            one(two, three)
        except TypeCheckError:
            wrong.append("checked")
        except ValueError:
            wrong.append("numpy's own")
    assert wrong.count("checked") == 3
    begin_test()
    with pytest.raises(TypeCheckError):
        one(two, three)


def test_labcal_is_checked_once_a_call() -> None:
    # Else jaxtyping does it in its way, and the tests take twice as long.
    assert DotGrid.points.__globals__["__name__"] == "annotation_checks"
    with pytest.raises(RuntimeError, match="imported before"):
        check_once()
