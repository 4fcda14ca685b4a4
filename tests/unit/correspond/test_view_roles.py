import pytest

from labcal.correspond.view_roles import held_out_views, parse_hold_out
from labcal.errors import InputError

VIEWS = ("a", "b", "c", "d", "3", "f", "g")


def test_views_are_held_out_by_name_or_evenly() -> None:
    assert held_out_views(VIEWS, parse_hold_out("g,b", VIEWS)) == ("b", "g")
    assert held_out_views(VIEWS, parse_hold_out("2", VIEWS)) == ("b", "f")
    assert held_out_views(VIEWS, parse_hold_out("3", VIEWS)) == ("3",)  # a view of that name comes first
    assert held_out_views(VIEWS, 0) == held_out_views(VIEWS, ()) == held_out_views(VIEWS, "none") == ()
    assert held_out_views([*VIEWS, "none"], "none") == ("none",)  # a view of that name comes first
    assert len(held_out_views(VIEWS, 6)) == 6


def test_what_cannot_be_held_out_is_refused() -> None:
    with pytest.raises(InputError, match="no view to hold out named 'x'"):
        parse_hold_out("a,x", VIEWS)
    for all_of_them in (7, VIEWS):
        with pytest.raises(InputError, match="held out"):
            held_out_views(VIEWS, all_of_them)
    with pytest.raises(InputError, match="no view to hold out named 'x'"):
        held_out_views(VIEWS, ["x"])
