import numpy as np
import pytest

from labcal.cameras.triangulation import epipolar_distances
from labcal.errors import InputError
from labcal.geometry.poses import rotation_vector
from labcal.scene.catalogue import load_scene
from labcal.scene.check import check_scene
from labcal.scene.mistakes import Mistake, Outcome
from labcal.scene.model import Scene
from labcal.scene.plan import built_scene, planned_takes
from labcal.scene.print import TruePrint
from labcal.scene.take import Take
from labcal.scene.truth import true_dots
from labcal.scene.views import planned_views
from labcal.shoot.truth import TrueDots

SEEDS = (0, 1, 2)


def seen(scene: Scene, take: Take) -> TrueDots:
    return true_dots(scene, TruePrint.of(scene.target, scene.board, 0), take)


def scene_with(name: str, mistake: str) -> Scene:
    return load_scene(name, (f"mistake={mistake}",))


def outcome(scene: Scene, seed: int, count: int | None = None) -> Outcome:
    return planned_takes(scene, planned_views(scene, seed)[:count], seed)


def pairs(takes: tuple[Take, ...]) -> list[tuple[Take, Take]]:
    return list(zip(takes[::2], takes[1::2], strict=True))


def epipolar_rms(scene: Scene, pair: tuple[Take, Take]) -> float:
    """Return the RMS distance of the delivered dots from the epipolar curves of the cameras as planned."""
    left, right = (seen(built_scene(scene), take) for take in pair)
    both = left.visible & right.visible
    cameras = scene.true_cameras()
    distances = epipolar_distances(
        cameras["left"], cameras["right"], left.centroid[both], right.centroid[both]
    )
    return float(np.sqrt(np.nanmean(distances**2)))


@pytest.mark.parametrize("name", ["webcam-volume", "webcam-handheld"])
def test_without_a_mistake_everything_is_as_planned(name: str) -> None:
    scene = load_scene(name, ("mistake=none",))
    views = planned_views(scene, 0)
    done = planned_takes(scene, views, 0)
    assert scene.mistake is None
    assert (done.wrong, done.wrong_views) == (None, ())
    assert [(take.view, take.camera, take.taken_by) for take in done.takes] == [
        (view.name, camera, camera) for view in views for camera in ("left", "right")
    ]
    for take in done.takes:
        view = next(view for view in views if view.name == take.view)
        np.testing.assert_array_equal(take.track.T_world_target, view.T_world_target)
        np.testing.assert_array_equal(take.device.T_cam_world, scene.true_cameras()[take.camera].T_cam_world)
        assert take.photometry(scene.photometry) == scene.photometry
    # Centroids are a little off the dots' centres, hence off the epipolar curves.
    assert max(epipolar_rms(scene, pair) for pair in pairs(done.takes)) < 0.05
    assert built_scene(scene) == scene


@pytest.mark.parametrize("seed", SEEDS)
def test_swapped_cameras_exchange_pictures_from_the_middle_view_on(seed: int) -> None:
    scene, plain = scene_with("webcam-handheld", "swapped-cameras"), load_scene("webcam-handheld")
    done, meant = outcome(scene, seed), pairs(outcome(plain, seed).takes)
    assert done.wrong_views == tuple(f"pose-{number:02d}" for number in range(11, 21))
    for number, (pair, as_meant) in enumerate(zip(pairs(done.takes), meant, strict=True)):
        left, right = pair
        assert (left.camera, right.camera) == ("left", "right")
        assert (left.taken_by, right.taken_by) == (("left", "right") if number < 10 else ("right", "left"))
        source = as_meant if number < 10 else as_meant[::-1]
        for take, other in zip(pair, source, strict=True):
            np.testing.assert_array_equal(seen(scene, take).centroid, seen(scene, other).centroid)
        assert (epipolar_rms(scene, pair) > 5.0) == (number >= 10)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("name", ["webcam-handheld", "still-volume"])
def test_a_knocked_camera_is_elsewhere_for_good(name: str, seed: int) -> None:
    scene = scene_with(name, "camera-knocked")
    done = outcome(scene, seed)
    planned = scene.true_cameras()["right"]
    middle = len(pairs(done.takes)) // 2
    knocks = []
    for number, pair in enumerate(pairs(done.takes)):
        np.testing.assert_array_equal(pair[0].device.T_cam_world, scene.true_cameras()["left"].T_cam_world)
        if number >= middle:
            assert pair[1].view in done.wrong_views
            assert epipolar_rms(scene, pair) > 1.0
            knocks.append(pair[1].device.T_cam_world @ np.linalg.inv(planned.T_cam_world))
        else:
            np.testing.assert_array_equal(pair[1].device.T_cam_world, planned.T_cam_world)
    for knock in knocks:
        np.testing.assert_array_equal(knock, knocks[0])
    assert np.degrees(np.linalg.norm(rotation_vector(knocks[0]))) == pytest.approx(0.5)
    assert np.linalg.norm(knocks[0][:3, 3]) == pytest.approx(3.0)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("name", ["webcam-handheld", "still-volume"])
def test_a_pair_out_of_step_sees_the_target_in_two_places(name: str, seed: int) -> None:
    scene = scene_with(name, "unsynchronised")
    done = outcome(scene, seed)
    assert done.wrong_views == tuple(view.name for view in planned_views(scene, seed))
    drifts, distances = [], []
    middle = np.array([350.0, 350.0, 0.0, 1.0])
    for left, right in pairs(done.takes):
        first, second = left.track.T_world_target, right.track.T_world_target
        drift = (second @ middle - first @ middle)[:3]
        np.testing.assert_allclose(right.track.middle, (second @ middle)[:3])
        assert np.linalg.norm(drift) == pytest.approx(4.0)
        turn = rotation_vector(second @ np.linalg.inv(first))
        assert np.degrees(np.linalg.norm(turn)) == pytest.approx(0.4)
        drifts.append(drift)
        distances.append(epipolar_rms(scene, (left, right)))
    assert np.linalg.matrix_rank(np.array(drifts)) == 3  # each view another way, so no rig explains them
    assert np.median(distances) > 0.5


@pytest.mark.parametrize(
    ("name", "count", "chosen"),
    [
        ("webcam-volume", None, "train-3"),
        ("webcam-volume", 3, "train-2"),
        ("webcam-plane", None, "test-shifted"),
    ],
)
def test_a_turned_board_lies_in_its_place_the_wrong_way_round(
    name: str, count: int | None, chosen: str
) -> None:
    scene = scene_with(name, "board-turned")
    done = outcome(scene, 0, count)
    views = {view.name: view for view in planned_views(scene, 0)}
    assert done.wrong_views == (chosen,)
    for take in done.takes:
        nominal = views[take.view].T_world_target_nominal
        assert nominal is not None
        true, meant = seen(scene, take), nominal[:3, 3] + scene.target.points()
        if take.view == chosen:
            # Of 13 x 10 dots that lie on each other when turned, (col, row) goes to (12 - col, 9 - row).
            np.testing.assert_allclose(true.point[::-1], meant, atol=1e-9)
            assert true.visible.all()
        else:
            np.testing.assert_allclose(true.point, meant, atol=1e-9)


def test_a_wrong_pitch_moves_the_dots_and_not_their_size() -> None:
    scene = scene_with("webcam-plane", "wrong-pitch")
    built = built_scene(scene)
    assert built.target.pitch_x_mm == pytest.approx(1.03 * scene.target.pitch_x_mm)
    assert built.target.pitch_y_mm == pytest.approx(1.03 * scene.target.pitch_y_mm)
    assert built.target.dot_diameter_mm == scene.target.dot_diameter_mm
    take = outcome(scene, 0).takes[0]
    true = seen(built, take)
    np.testing.assert_allclose(true.point[-1], [650.0 + 1.03 * 700.0, 650.0 + 1.03 * 700.0, 200.0])
    meant = seen(scene, outcome(load_scene("webcam-plane"), 0).takes[0])
    moved = np.linalg.norm(true.centre - meant.centre, axis=1)
    assert moved[0] == 0.0
    assert moved[-1] > 5.0
    assert true.visible.mean() > 0.8


@pytest.mark.parametrize("only", [None, "left"])
def test_out_of_focus_blurs_one_camera(only: str | None) -> None:
    scene = scene_with("webcam-plane", "out-of-focus")
    if only:
        scene = scene.model_copy(update={"cameras": {only: scene.cameras[only]}})
    blurred = only or "right"
    for take in outcome(scene, 0).takes:
        expected = np.hypot(0.8, 1.28) if take.camera == blurred else 0.8
        assert take.photometry(scene.photometry).blur_px == pytest.approx(expected)


@pytest.mark.parametrize("mistake", list(Mistake))
@pytest.mark.parametrize("name", ["webcam-volume", "still-handheld"])
def test_every_mistake_can_be_rendered_and_is_described(name: str, mistake: Mistake) -> None:
    if name == "still-handheld" and mistake is Mistake.BOARD_TURNED:
        return
    few = ("placement.train=3", "placement.test=1") if name == "still-handheld" else ()
    scene = load_scene(name, (f"mistake={mistake}", *few))
    check_scene(scene, seed=0)
    views = planned_views(scene, 4)
    once, again = planned_takes(scene, views, 4), planned_takes(scene, views, 4)
    assert once.wrong is not None
    assert once.wrong.endswith(".")
    assert 0 < len(once.wrong_views) <= len(views)
    for a, b in zip(once.takes, again.takes, strict=True):
        np.testing.assert_array_equal(a.track.T_world_target, b.track.T_world_target)
        np.testing.assert_array_equal(a.device.T_cam_world, b.device.T_cam_world)


@pytest.mark.parametrize("mistake", ["swapped-cameras", "unsynchronised", "camera-knocked"])
def test_mistakes_of_a_pair_are_refused_with_one_camera(mistake: str) -> None:
    scene = scene_with("webcam-volume", mistake)
    alone = scene.model_copy(update={"cameras": {"left": scene.cameras["left"]}})
    with pytest.raises(InputError, match=f"'{mistake}' takes two cameras"):
        check_scene(alone, seed=0)


def test_mistakes_that_mean_nothing_are_refused_by_name() -> None:
    with pytest.raises(InputError, match="'board-turned' means nothing for a target in the hand"):
        check_scene(scene_with("webcam-handheld", "board-turned"), seed=0)
    for mistake in ("swapped-cameras", "board-turned", "camera-knocked"):
        with pytest.raises(InputError, match=f"'{mistake}' happens between views"):
            check_scene(scene_with("webcam-volume", mistake), seed=0, count=1)
    with pytest.raises(InputError, match="swapped-cameras"):
        scene_with("webcam-volume", "swopped-cameras")


def test_pictures_of_two_sizes_cannot_be_exchanged() -> None:
    scene = load_scene("webcam-volume", ("mistake=swapped-cameras", "cameras.left.size=[638, 480]"))
    with pytest.raises(InputError, match=r"one size.*638"):
        check_scene(scene, seed=0)


def test_a_mistake_has_a_size() -> None:
    knocked = load_scene("webcam-handheld", ("mistake=camera-knocked", "mistake_size=0.1"))
    (_, last) = pairs(outcome(knocked, 0, 4).takes)[-1]
    knock = last.device.T_cam_world @ np.linalg.inv(knocked.true_cameras()["right"].T_cam_world)
    assert np.degrees(np.linalg.norm(rotation_vector(knock))) == pytest.approx(0.05)
    assert np.linalg.norm(knock[:3, 3]) == pytest.approx(0.3)
    usual = outcome(scene_with("webcam-handheld", "unsynchronised"), 0, 2)
    half = outcome(load_scene("webcam-handheld", ("mistake=unsynchronised", "mistake_size=0.5")), 0, 2)
    meant = outcome(load_scene("webcam-handheld"), 0, 2)
    for (_, far), (_, near), (_, still) in zip(
        *(pairs(one.takes) for one in (usual, half, meant)), strict=True
    ):
        moved = [one.track.middle - still.track.middle for one in (far, near)]
        np.testing.assert_allclose(moved[1], 0.5 * moved[0])
    one = load_scene("webcam-handheld", ("mistake=swapped-cameras", "mistake_size=0.25"))
    assert outcome(one, 0, 8).wrong_views == ("pose-08",)
    assert "mistake_size" not in load_scene("webcam-handheld").to_yaml()
    assert "mistake_size: 0.25" in one.to_yaml()
    for changes in (("mistake=swapped-cameras", "mistake_size=2"), ("mistake_size=0",)):
        with pytest.raises(InputError, match="mistake_size"):
            outcome(load_scene("webcam-handheld", changes), 0, 4)
    with pytest.raises(InputError, match="Leave mistake_size out"):
        outcome(load_scene("webcam-plane", ("mistake=board-turned", "mistake_size=0.5")), 0)


def test_a_refocused_lens_has_another_focal_length_later() -> None:
    takes = outcome(scene_with("webcam-volume", "refocused"), 0).takes
    focal = {(take.view, take.camera): float(take.device.K[0, 0]) for take in takes}
    views = list(dict.fromkeys(take.view for take in takes))
    for at, view in enumerate(views):
        later = at >= len(views) // 2
        assert focal[view, "right"] == pytest.approx(704.0 * (1.01 if later else 1.0))
        assert focal[view, "left"] == pytest.approx(700.0)


def test_a_print_with_a_code_has_no_wrong_pitch_of_its_own() -> None:
    """Its code would describe the wrong board."""
    scene = load_scene("webcam-handheld", ("mistake=wrong-pitch",))
    assert built_scene(scene).target != scene.target
    coded = scene.model_copy(update={"board": scene.board.model_copy(update={"print_number": 3})})
    with pytest.raises(InputError, match=r"Leave out board\.print_number"):
        built_scene(coded)
