"""The scale of a print: stated once, kept with the target, and in every place and size of it."""

import numpy as np
import pytest
from pydantic import TypeAdapter

from labcal.errors import InputError
from labcal.targets.artwork import ArtworkFormat, draw_artwork
from labcal.targets.catalogue import DescribedTarget, load_target, target_names
from labcal.targets.print_scale import print_scale, printed_to_scale


@pytest.mark.parametrize(
    ("given", "scale"),
    [
        ("99.8/100", (0.998, 0.998)),
        ("199.6/200,100.1/100", (0.998, 1.001)),
        (1.002, (1.002, 1.002)),
        ((0.99, 1.01), (0.99, 1.01)),
    ],
)
def test_a_scale_is_measured_over_nominal(given: object, scale: tuple[float, float]) -> None:
    assert print_scale(given) == pytest.approx(scale)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "given", ["99.8", "99.8/0", "a/b", "1/2/3", "9/10,9/10,9/10", "99.8mm/100mm", "1/100"]
)
def test_other_forms_are_refused(given: str) -> None:
    with pytest.raises(InputError, match=r"MEASURED/NOMINAL|between"):
        print_scale(given)


def test_what_is_no_number_is_refused() -> None:
    with pytest.raises(InputError, match="between"):
        print_scale(float("nan"))


@pytest.mark.parametrize("name", target_names())
def test_places_sizes_and_edges_are_those_of_the_print(name: str) -> None:
    target = load_target(name)
    printed = printed_to_scale(target, "99.8/100,100.2/100")
    np.testing.assert_allclose(printed.points(), target.points() * [0.998, 1.002, 1.0])
    np.testing.assert_allclose(printed.outer_diameters_mm(), target.outer_diameters_mm(), rtol=1e-5)
    wanted = np.array(target.extent_mm) * [0.998, 1.002, 0.998, 1.002]
    np.testing.assert_allclose(printed.extent_mm, wanted)
    back = TypeAdapter(DescribedTarget).validate_python(printed.model_dump(mode="json"))
    assert back == printed
    assert "print_scale" not in target.model_dump()


def test_a_scale_is_stated_once_and_no_design_is_drawn_with_it() -> None:
    printed = printed_to_scale(load_target("rings-10x8"), 0.998)
    with pytest.raises(InputError, match=r"stated already: 0\.998"):
        printed_to_scale(printed, 0.998)
    with pytest.raises(InputError, match="print_scale"):
        draw_artwork(printed, ArtworkFormat.SVG)
