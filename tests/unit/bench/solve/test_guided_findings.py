"""Figures of many guided captures: the limit that is used, and the share of single ones within it."""

from labcal.bench.solve import guided
from labcal.bench.solve.guided_set import GuidedFigures


def capture(actual_mm: float) -> GuidedFigures:
    return GuidedFigures(
        views=8,
        reached=True,
        random_views=20,
        asked=14,
        found=14,
        stated_mm=1.0,
        actual_mm=actual_mm,
        stated_shape_mm=1.0,
        actual_shape_mm=1.0,
        expected_mm=1.0,
        stated_calibration_mm=1.0,
    )


def test_the_limit_is_named_with_what_chance_is_granted() -> None:
    found = [capture(error) for error in (0.5, 1.1, 0.9, 1.4)]
    findings = guided._findings(guided._Rig("narrow", 1.0, []), found)
    (check,) = [one for one in findings.checks if "3-D error at the end" in one.name]
    assert "limit: 20%, and " in check.name
    granted = float(check.name.split("and ")[1].split("%")[0]) / 100
    assert abs(check.limit - 0.2 - granted) < 1e-3
    shares = {one.name: one.value for one in findings.references if "share of captures with" in one.name}
    assert sorted(shares.values()) == [0.5, 1.0]
