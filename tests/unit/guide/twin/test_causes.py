"""Causes of residuals: each is found where it was made, and none in noise."""

import numpy as np
import pytest

from labcal.guide.twin.cause_designs import CauseKind
from labcal.guide.twin.causes import explained
from labcal.guide.twin.residuals import DotResiduals
from labcal.guide.twin.unexplained_positions import unexplained_positions

SIGMA = 0.01
PX_PER_MM = 10.0
VIEWS, COLS, ROWS = 8, 9, 7


def residuals(seed: int) -> tuple[DotResiduals, np.ndarray]:
    """Noise of two cameras that see a board in eight poses, turned in the picture and tilted."""
    random = np.random.default_rng(seed)
    x, y = np.meshgrid(np.arange(COLS) * 10.0, np.arange(ROWS) * 10.0)
    dots = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=-1)
    lines = []
    for view in range(VIEWS):
        for camera in range(2):
            turn, tilt = random.uniform(-np.pi, np.pi), random.uniform(-0.6, 0.6, 2)
            R = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
            J = PX_PER_MM * R @ np.array([[np.cos(tilt[0]), 0, tilt[0]], [0, np.cos(tilt[1]), tilt[1]]])
            q = (dots - dots.mean(axis=0)) @ J.T + 500.0 + random.uniform(-80.0, 80.0, 2)
            lines.append((camera, view, q, J))
    n = len(dots)
    covariance = np.tile(SIGMA**2 * np.eye(2), (n * len(lines), 1, 1))
    noise = SIGMA * random.standard_normal((n * len(lines), 2))
    made = DotResiduals(
        camera=np.repeat([camera for camera, *_ in lines], n),
        view=np.repeat([view for _, view, *_ in lines], n),
        dot=np.tile(np.arange(n), len(lines)),
        picture=np.repeat(np.arange(len(lines)), n),
        q=np.concatenate([q for *_, q, _ in lines]),
        residual=noise,
        covariance=covariance,
        by_point=np.concatenate([np.tile(J, (n, 1, 1)) for *_, J in lines]),
        scale=1.0,
    )
    return made, dots


def with_cause(made: DotResiduals, moved: np.ndarray) -> DotResiduals:
    """Return residuals that something adds to."""
    return DotResiduals(**{**made.__dict__, "residual": made.residual + moved})


def test_noise_has_no_cause() -> None:
    levels = []
    for seed in range(20):
        told = explained(*residuals(seed))
        assert not told.causes
        assert told.noise > 0.9
        levels.append(told.level)
    freedom = 20 * 2 * COLS * ROWS * 2 * VIEWS
    assert abs(np.mean(levels) - 1.0) < 4.0 * np.sqrt(2.0 / freedom)


def test_two_views_that_hardly_differ_show_noise_alone() -> None:
    for seed in range(2):
        made, dots = residuals(seed)
        here = made.view < 2
        view = made.view[here]
        one = {name: value[here] for name, value in made.__dict__.items() if isinstance(value, np.ndarray)}
        J = made.by_point[(made.view == 0) & (made.camera == 0)][0]
        shift = np.where(view[:, None] == 1, 40.0, 0.0)
        q = (dots[one["dot"]] - dots.mean(axis=0)) @ J.T + 500.0 + shift
        flat = np.tile(J, (len(view), 1, 1))
        found = DotResiduals(**{**one, "q": q, "by_point": flat, "scale": 1.0})
        assert not explained(found, dots).causes


def test_a_column_printed_aside_is_the_print() -> None:
    made, dots = residuals(1)
    shift = np.where(dots[:, :1] == 30.0, [[0.01, 0.0, 0.0]], 0.0)  # 10 um, a tenth of a pixel
    found = with_cause(made, np.einsum("nij,nj->ni", made.by_point, shift[made.dot]))
    told = explained(found, dots)
    assert told.causes[0].kind is CauseKind.PRINT
    assert told.causes[0].p_value < 1e-6
    words = unexplained_positions(told, found)[0]
    assert words.kind == "print"
    # One of nine columns; the poses take a little of it.
    assert words.size == pytest.approx(10.0 / 3.0, rel=0.25)
    assert told.left_level < 1.1


def test_a_smooth_field_of_one_camera_is_the_lens() -> None:
    made, dots = residuals(2)
    r = (made.q - 500.0) / 500.0
    field = np.where(made.camera[:, None] == 1, 0.3 * r * (r**2).sum(axis=1, keepdims=True), 0.0)
    told = explained(with_cause(made, field), dots)
    assert told.causes[0].kind is CauseKind.LENS
    assert told.left_level < 1.2


def test_a_shifted_picture_is_one_that_does_not_agree() -> None:
    made, dots = residuals(3)
    moved = np.where(made.picture[:, None] == 4, [[0.1, 0.0]], 0.0)
    found = with_cause(made, moved)
    told = explained(found, dots)
    assert told.causes[0].kind is CauseKind.PICTURES
    names = [f"view-{p // 2}/camera-{p % 2}" for p in range(2 * VIEWS)]
    assert "view-2/camera-0" in unexplained_positions(told, found, names)[0].pictures


def test_shares_add_up() -> None:
    made, dots = residuals(4)
    shift = 0.02 * np.random.default_rng(0).standard_normal((len(dots), 3)) * [1.0, 1.0, 0.0]
    found = with_cause(made, np.einsum("nij,nj->ni", made.by_point, shift[made.dot]))
    told = explained(found, dots)
    assert told.noise + sum(cause.share for cause in told.causes) + told.rest == pytest.approx(1.0)
    assert told.causes[0].share > 0.9


def few(made: DotResiduals, views: int, cameras: int) -> DotResiduals:
    """Return the residuals of the first views and cameras."""
    keep = (made.view < views) & (made.camera < cameras)
    lines = {key: value[keep] for key, value in made.__dict__.items() if isinstance(value, np.ndarray)}
    lines["picture"] = np.unique(lines["picture"], return_inverse=True)[1]
    return DotResiduals(**lines, scale=made.scale)


def bent(made: DotResiduals, dots: np.ndarray) -> DotResiduals:
    height = np.zeros((len(dots), 3))
    height[:, 2] = 0.1 * ((dots[:, 0] - 40.0) / 40.0) ** 2
    return with_cause(made, np.einsum("nij,nj->ni", made.by_point, height[made.dot]))


@pytest.mark.parametrize(
    ("views", "cameras", "rivals"),
    [
        (1, 1, {CauseKind.PRINT, CauseKind.LENS}),  # dots of one picture can be anything's
        (1, 2, {CauseKind.LENS}),  # a print is the same for both cameras, a lens is not
        (2, 1, set()),
        (3, 2, set()),
    ],
)
def test_a_bend_is_told_from_others_where_views_can_tell(
    views: int, cameras: int, rivals: set[CauseKind]
) -> None:
    for seed in range(5):
        made, dots = residuals(seed)
        found = bent(few(made, views, cameras), dots)
        told = explained(found, dots)
        assert told.causes[0].kind is CauseKind.BEND
        assert set(told.causes[0].rivals) == rivals
        kind = unexplained_positions(told, found)[0].kind
        assert kind == ("undecided" if rivals else "bend")


@pytest.mark.parametrize("seed", [21, 22])
def test_causes_that_one_view_hardly_distinguishes_are_not_larger_than_what_is_there(seed: int) -> None:
    made, dots = residuals(seed)
    made = few(made, 1, 2)
    n, across = len(dots), (dots - dots.mean(axis=0))[:, 0]
    q, by_point = made.q.copy(), made.by_point.copy()
    q[n:], by_point[n:] = q[:n] + 40.0, by_point[:n] * 1.02
    for camera, towards in enumerate((-1e-4, 1e-4)):  # a little perspective, another one in either camera
        mine, nearer = slice(camera * n, (camera + 1) * n), 1.0 + towards * across
        q[mine] = 500.0 + (q[mine] - 500.0) * nearer[:, None]
        by_point[mine] *= nearer[:, None, None] ** 2
    made = DotResiduals(**{**made.__dict__, "q": q, "by_point": by_point})
    shift = 0.05 * np.random.default_rng(seed).standard_normal((n, 3)) * [1.0, 1.0, 0.0]
    r = (made.q - 500.0) / 500.0
    field = np.where(made.camera[:, None] == 1, 0.6, 0.0) * r * (r**2).sum(axis=1, keepdims=True)
    found = with_cause(made, field + np.einsum("nij,nj->ni", made.by_point, shift[made.dot]))
    told = explained(found, dots)
    assert {cause.kind for cause in told.causes} == {CauseKind.PRINT, CauseKind.LENS}
    for cause in told.causes:
        assert (cause.fit**2).sum() <= (found.residual**2).sum()
