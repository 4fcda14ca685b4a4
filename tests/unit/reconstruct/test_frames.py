"""Frames that a user names: transforms are found, covariances hold the scatter, bad ones are refused."""

from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from labcal import InputError, NamedPixels, NamedReconstruction, examples, load_target, pipeline
from labcal.correspond.named_points import NamedPoints
from labcal.errors import UnknownNameError
from labcal.geometry.poses import from_rotation_vector
from labcal.pipeline import MeasureSettings
from labcal.reconstruct.frames.by_known import MeasuredKnown, frame_by_known
from labcal.reconstruct.frames.by_points import frame_by_points
from labcal.reconstruct.frames.fitted_frame import FittedFrame, FrameKind
from labcal.reconstruct.frames.requested_frame import RequestedFrame

NAMES = ("o", "x", "xy", "far", "up", "other")
R_BA = from_rotation_vector(np.array([0.4, -0.9, 0.3]), np.zeros(3))[:3, :3]
T_BA = np.array([30.0, -20.0, 400.0])
IN_B = np.array(
    [[0, 0, 0], [100, 0, 0], [30, 80, 0], [60, 50, -70], [-20, 40, 60], [10, -90, 25]], dtype=np.float64
)
"""Places in the frame of the three points; the first three determine it."""


def in_a(scale: float = 1.0) -> np.ndarray:
    """Return the places in the world of the model, in which the frame lies anyhow."""
    return (IN_B - T_BA) @ R_BA / scale


def covariances() -> np.ndarray:
    """Return covariances of unlike sizes and directions, largest along depth."""
    rng = np.random.default_rng(8)
    root = rng.normal(size=(len(IN_B), 3, 3)) * [0.02, 0.02, 0.08]
    return root @ root.swapaxes(1, 2) + 1e-5 * np.eye(3)


def named(p: np.ndarray) -> NamedPoints:
    return NamedPoints(
        np.full(len(p), "v"), NAMES[: len(p)], p, covariances()[: len(p)], np.full(len(p), "ok")
    )


def scattered(rng: np.random.Generator, scale: float = 1.0) -> np.ndarray:
    root = np.linalg.cholesky(covariances())
    return in_a(scale) + np.einsum("nij,nj->ni", root, rng.normal(size=(len(IN_B), 3)))


def normalised(error: np.ndarray, covariance: np.ndarray) -> float:
    return float(error @ np.linalg.solve(covariance, error))


def by_points(p: np.ndarray) -> FittedFrame:
    return frame_by_points("v", ("o", "x", "xy"), p[:3], covariances()[:3])


def known(p: np.ndarray, chosen: list[int], sigma: float = 0.0, place: np.ndarray = IN_B) -> MeasuredKnown:
    return MeasuredKnown(
        "v", tuple(NAMES[i] for i in chosen), p[chosen], covariances()[chosen], place[chosen],
        np.tile(sigma**2 * np.eye(3), (len(chosen), 1, 1)),
    )  # fmt: skip


def test_three_points_give_the_frame_that_they_lie_in() -> None:
    frame = by_points(in_a())
    np.testing.assert_allclose(frame.applied(named(in_a())).point, IN_B, atol=1e-10)
    np.testing.assert_allclose(frame.R_ba, R_BA, atol=1e-12)


def test_coordinates_by_decree_are_exact() -> None:
    found = by_points(scattered(np.random.default_rng(0))).applied(named(scattered(np.random.default_rng(0))))
    assert (found.point[0] == 0).all()
    assert (found.covariance[0] == 0).all()
    assert (found.point[1, 1:] == 0).all()
    assert np.count_nonzero(found.covariance[1]) == 1
    assert found.point[2, 2] == 0
    assert (found.covariance[2, 2] == 0).all()
    assert found.covariance[2, 1, 1] > 0


def test_covariances_in_a_frame_of_three_points_hold_the_scatter() -> None:
    """Also of the points that determine it, which are correlated with it."""
    rng, rounds = np.random.default_rng(2), 250
    free = [np.arange(3), np.arange(1), np.arange(2)]
    chi = {name: [] for name in NAMES}
    for _ in range(rounds):
        p = scattered(rng)
        found = by_points(p).applied(named(p))
        for i, name in enumerate(NAMES[1:], start=1):
            keep = {1: free[1], 2: free[2]}.get(i, free[0])
            error = (found.point[i] - IN_B[i])[keep]
            chi[name].append(normalised(error, found.covariance[i][np.ix_(keep, keep)]))
    for name, freedom in (("x", 1), ("xy", 2), ("far", 3), ("up", 3), ("other", 3)):
        assert stats.kstest(chi[name], stats.chi2(freedom).cdf).pvalue > 1e-3, name


@pytest.mark.parametrize("kind", [FrameKind.RIGID, FrameKind.SIMILARITY])
def test_covariances_in_a_frame_of_known_points_hold_the_scatter(kind: FrameKind) -> None:
    """Four points determine it, one of which is looked at; another is not among them. Known ones err, too."""
    rng, rounds, chosen = np.random.default_rng(4), 120, [0, 1, 2, 4]
    scale = 1.02 if kind is FrameKind.SIMILARITY else 1.0
    chi_own, chi_other, chi_rest, chi_frame = [], [], [], []
    for _ in range(rounds):
        p = scattered(rng, scale)
        surveyed = IN_B + 0.03 * rng.normal(size=IN_B.shape)
        frame = frame_by_known(kind, known(p, chosen, 0.03, surveyed))
        found = frame.applied(named(p))
        chi_own.append(normalised(found.point[4] - IN_B[4], found.covariance[4]))
        chi_other.append(normalised(found.point[3] - IN_B[3], found.covariance[3]))
        assert frame.sigma0 is not None
        chi_rest.append(frame.sigma0**2 * (12 - frame.slopes.shape[1]))
        off = [*(frame.t_ba - T_BA), *([np.log(frame.scale / scale)] if scale != 1.0 else [])]
        chi_frame.append(normalised(np.array(off), frame.parameter_covariance[3:, 3:]))
    degrees = 5 if kind is FrameKind.SIMILARITY else 6
    for values, freedom in ((chi_own, 3), (chi_other, 3), (chi_rest, degrees), (chi_frame, 9 - degrees)):
        assert stats.kstest(values, stats.chi2(freedom).cdf).pvalue > 1e-3


def test_a_similarity_finds_the_scale_and_a_rigid_frame_says_that_it_does_not_fit() -> None:
    p = in_a(1.01)
    fitted = frame_by_known(FrameKind.SIMILARITY, known(p, [0, 1, 2, 3]))
    assert fitted.scale == pytest.approx(1.01, abs=1e-12)
    assert fitted.rms_mm < 1e-9
    assert fitted.warnings == ()
    rigid = frame_by_known(FrameKind.RIGID, known(p, [0, 1, 2, 3]))
    assert rigid.sigma0 is not None
    assert rigid.sigma0 > 3
    assert "times what their covariances explain" in rigid.warnings[0]


def test_a_mirrored_set_is_not_made_to_fit_by_a_reflection() -> None:
    with pytest.raises(InputError, match="Compare names, units and signs"):
        frame_by_known(FrameKind.RIGID, known(in_a() * [1, 1, -1], [0, 1, 2, 3, 4, 5]))


@pytest.mark.parametrize("share", [0.01, 0.05, 0.1])
def test_known_points_that_fit_badly_still_give_the_least_squares_frame(share: float) -> None:
    """Errors of up to a tenth of the spread: found, warned of, and no step in any direction is better."""
    wrong = IN_B + share * 100.0 * np.random.default_rng(6).normal(size=IN_B.shape)
    given = known(in_a(), [0, 1, 2, 3, 4, 5], 0.5, wrong)
    frame = frame_by_known(FrameKind.RIGID, given)
    assert "times what their covariances explain" in frame.warnings[0]
    assert np.linalg.det(frame.R_ba) == pytest.approx(1.0)

    def chi_square(turn: np.ndarray, shift: np.ndarray) -> float:
        moved = given.measured @ frame.R_ba.T
        off = moved @ from_rotation_vector(turn, np.zeros(3))[:3, :3].T + frame.t_ba + shift - given.known
        weight = np.linalg.inv(frame.R_ba @ given.covariance @ frame.R_ba.T + given.known_covariance)
        return float(np.einsum("ni,nij,nj->", off, weight, off))

    least = chi_square(np.zeros(3), np.zeros(3))
    for axis in np.eye(3):
        for sign in (-1, 1):
            assert chi_square(1e-5 * sign * axis, np.zeros(3)) > least
            assert chi_square(np.zeros(3), 1e-3 * sign * axis) > least


def test_known_points_that_are_others_are_refused() -> None:
    """A point 100 m away, for example by a comma that was lost: no frame comes near, and that is said."""
    far = IN_B.copy()
    far[1, 0] = 1e5
    for kind in (FrameKind.RIGID, FrameKind.SIMILARITY):
        with pytest.raises(InputError, match="No frame brings the 4 measured points near"):
            frame_by_known(kind, known(in_a(), [0, 1, 2, 4], place=far))


LINE = np.array([[0.0, 0, 500], [50.0, 10, 520], [100.0, 20, 540], [150.0, 30, 560]])


def test_points_on_a_line_fix_no_frame() -> None:
    with pytest.raises(InputError, match=r"'o', 'x', 'xy' lie on a line, so that they fix no frame"):
        by_points(LINE)
    with pytest.raises(InputError, match="lie on a line"):
        by_points(LINE[[0, 0, 1]])
    with pytest.raises(InputError, match="lie on a line"):
        frame_by_known(FrameKind.RIGID, known(LINE, [0, 1, 2, 3], place=LINE))


def test_points_on_a_line_within_their_uncertainty_fix_no_frame() -> None:
    near = LINE + np.array([[0, 0, 0], [0, 0.02, 0], [0, -0.02, 0], [0, 0, 0]])
    with pytest.raises(InputError, match=r"within their uncertainty \(it leaves \d+ degrees open\)"):
        by_points(near)
    with pytest.raises(InputError, match="within their uncertainty"):
        frame_by_known(FrameKind.RIGID, known(near, [0, 1, 2, 3], place=near))


def measured(frame: str, view: str | None = None, target: str | None = None) -> NamedReconstruction:
    settings = MeasureSettings(frame=frame, frame_view=view)
    return pipeline.measure(examples.rig(), examples.pixels(), target, settings)


def test_a_table_of_known_points_is_a_frame(tmp_path: Path) -> None:
    path = tmp_path / "known.csv"
    block = {
        "origin": (0, 0, 0),
        "right-corner": (100, 0, 0),
        "far-corner": (0, 0, 90),
        "tip": (50, -40, -40),
    }
    lines = [f"{name},{x},{y},{z},0.01" for name, (x, y, z) in block.items()]
    path.write_text("\n".join(["point,X_mm,Y_mm,Z_mm,sigma_mm", *lines, "unseen,1,2,3,0.01"]) + "\n")
    found = measured(f"rigid:{path}")
    assert found.frame is not None
    assert found.frame.names == tuple(block)
    by_name = dict(zip(found.points.name.tolist(), found.points.point, strict=True))
    np.testing.assert_allclose(by_name["upper-corner"], [0, -70, 10], atol=0.5)
    path.write_text("point,X_mm,Y_mm,Z_mm\norigin,0,0,0\ntip,1,2,3\n")
    with pytest.raises(InputError, match=r"three of them or more, not on one line.*has 2 points"):
        measured(f"rigid:{path}")
    path.write_text("point,X_mm,Y_mm,Z_mm\norigin,0,0,0\norigin,1,2,3\n")
    with pytest.raises(InputError, match=r"Line 3 .* is of the same point as line 2"):
        measured(f"rigid:{path}")
    path.write_text("point,X_mm,Y_mm,Z_mm\norigin,0,0,\n")
    with pytest.raises(InputError, match=r"Line 2 .* has no coordinates"):
        measured(f"rigid:{path}")


def test_a_board_that_lies_in_a_frame_is_one(tmp_path: Path) -> None:
    """The frame is the board's; its dots, as named points, lie where the target says."""
    dots = examples.detections()
    dots.save(tmp_path / "detections.csv")
    of_view = dots.where(dots.view == "hand-2")
    names = [f"{col}-{row}" for col, row in of_view.index.tolist()]
    pixels = NamedPixels(of_view.view, of_view.camera, names, of_view.position, of_view.covariance)
    settings = MeasureSettings(frame=f"board:{tmp_path / 'detections.csv'}", frame_view="hand-2")
    found = pipeline.measure(examples.rig(), pixels, examples.TARGET, settings)
    col_row = np.array([list(map(int, name.split("-"))) for name in found.points.name.tolist()])
    off = found.points.point - load_target(examples.TARGET).points(col_row)
    assert np.abs(np.median(off, axis=0)).max() < 0.05
    assert found.frame is not None
    assert found.frame.sigma0 == pytest.approx(1.0, abs=0.2)
    with pytest.raises(InputError, match=r"has dots of 8 views .*`frame_view='VIEW'`"):
        measured(f"board:{tmp_path / 'detections.csv'}", target=examples.TARGET)
    with pytest.raises(InputError, match="`target='NAME'`"):
        measured(f"board:{tmp_path / 'detections.csv'}")


def test_a_frame_that_is_none_is_refused() -> None:
    for words in ("origin,x,y", "points:", "circle:a,b,c", ""):
        with pytest.raises(InputError, match="names no frame"):
            measured(words)
    with pytest.raises(InputError, match="takes three different names"):
        measured("points:origin,right-corner")
    with pytest.raises(InputError, match="takes three different names"):
        measured("points:origin,tip,origin")
    with pytest.raises(InputError, match="takes three different names"):  # before a table is read
        RequestedFrame.of("points:a,a,b")
    with pytest.raises(UnknownNameError, match="Did you mean 'origin'"):
        measured("points:orign,right-corner,upper-corner")
    with pytest.raises(InputError, match="`target` goes with a frame by a board"):
        measured("points:origin,right-corner,upper-corner", target=examples.TARGET)
    with pytest.raises(InputError, match="`frame_view` goes with a frame"):
        MeasureSettings(frame_view="v")
    with pytest.raises(UnknownNameError, match="no view in the pixels named 'blck'"):
        measured("points:origin,right-corner,upper-corner", "blck")


def test_a_frame_takes_the_points_of_one_view() -> None:
    one = examples.pixels()
    both = NamedPixels(
        [*one.view, *["later"] * len(one)], [*one.camera] * 2, [*one.point] * 2,
        np.concatenate([one.position, one.position + np.array([3.0, 0.0])]),
        np.concatenate([one.covariance] * 2),
    )  # fmt: skip
    frame = "points:origin,right-corner,upper-corner"
    with pytest.raises(InputError, match=r"measured in 2 views \(block, later\)"):
        pipeline.measure(examples.rig(), both, settings=MeasureSettings(frame=frame))
    found = pipeline.measure(examples.rig(), both, settings=MeasureSettings(frame=frame, frame_view="later"))
    origins = found.points.point[found.points.name == "origin"]
    assert (origins[1] == 0).all()
    assert np.linalg.norm(origins[0]) > 0.5
    assert (
        found.points.covariance[0] != 0
    ).any()  # the origin of the other view does not determine the frame
