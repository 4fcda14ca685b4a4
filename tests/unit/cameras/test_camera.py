import cv2
import numpy as np
import pytest

from labcal.cameras.blind_pixels import require_rays_everywhere
from labcal.cameras.camera import Camera
from labcal.cameras.lens import lens_by_name
from labcal.errors import InputError, UnknownNameError

IDENTITY = np.eye(4)
K = np.array([[700.0, 0.0, 319.5], [0.0, 700.0, 239.5], [0.0, 0.0, 1.0]])
PLAIN = np.zeros(5)
FOLDED = np.array([-0.3, 0.0, 0.0, 0.0, 0.0])
FOLD = np.sqrt(1 / 0.9)  # where r (1 - 0.3 r^2) stops growing
FOLD_IMAGE = FOLD * 2 / 3
NONE_OF_OPENCVS = "none of OpenCV's lenses: tests of its own hold it against its formula"


def barrel(focal_px: float) -> Camera:
    K = np.array([[focal_px, 0.0, 319.5], [0.0, focal_px, 239.5], [0.0, 0.0, 1.0]])
    return Camera(K, "brown5", FOLDED, IDENTITY, (640, 480))


def opencv(camera: Camera, points: np.ndarray) -> np.ndarray:
    rotation, _ = cv2.Rodrigues(camera.T_cam_world[:3, :3])
    if camera.lens == "fisheye-kb4":
        q, _ = cv2.fisheye.projectPoints(
            points[:, None], rotation, camera.T_cam_world[:3, 3], camera.K, camera.dist[:4]
        )
    else:
        q, _ = cv2.projectPoints(points, rotation, camera.T_cam_world[:3, 3], camera.K, camera.dist)
    return q[:, 0]


def test_projects_as_opencv(camera: Camera, points: np.ndarray) -> None:
    if camera.model.opencv is None:
        pytest.skip(NONE_OF_OPENCVS)
    found = camera.project(points)
    assert found.ok.all()
    np.testing.assert_allclose(found.q, opencv(camera, points), rtol=0, atol=1e-9)


def test_rays_are_the_undistorted_pixels_of_opencv(camera: Camera, points: np.ndarray) -> None:
    if camera.model.opencv is None:
        pytest.skip(NONE_OF_OPENCVS)
    q = camera.project(points).q
    criteria = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 500, 1e-15)
    # OpenCV 5 gave undistortPoints the criteria that in OpenCV 4 only undistortPointsIter takes.
    undistort = getattr(cv2, "undistortPointsIter", cv2.undistortPoints)
    if camera.lens == "fisheye-kb4":
        ideal = cv2.fisheye.undistortPoints(q[:, None], camera.K, camera.dist[:4], criteria=criteria)[:, 0]
    else:
        ideal = undistort(q[:, None], camera.K, camera.dist, R=np.eye(3), P=np.eye(3), criteria=criteria)[
            :, 0
        ]
    rays = camera.rays(q)
    assert rays.ok.all()
    local = rays.direction @ camera.T_cam_world[:3, :3].T
    np.testing.assert_allclose(local[:, :2] / local[:, 2:], ideal, rtol=0, atol=1e-10)
    np.testing.assert_allclose(np.linalg.norm(rays.direction, axis=1), 1, atol=1e-14)
    expected_centre = -camera.T_cam_world[:3, :3].T @ camera.T_cam_world[:3, 3]
    np.testing.assert_allclose(rays.origin, np.tile(expected_centre, (len(q), 1)), atol=1e-10)
    np.testing.assert_allclose(camera.centre, expected_centre, atol=1e-10)


def test_a_ray_passes_through_the_point_that_is_imaged(camera: Camera, points: np.ndarray) -> None:
    rays = camera.rays(camera.project(points).q)
    offset = np.cross(points - rays.origin, rays.direction)
    assert np.linalg.norm(offset, axis=1).max() < 1e-8


def test_batches_keep_their_shape(camera: Camera, points: np.ndarray) -> None:
    q = camera.project(points.reshape(5, 100, 3)).q
    np.testing.assert_array_equal(q.reshape(-1, 2), camera.project(points).q)
    assert camera.rays(q).direction.shape == (5, 100, 3)
    assert camera.point_jacobian(points.reshape(5, 100, 3)).shape == (5, 100, 2, 3)


def test_the_point_jacobian_is_the_slope(camera: Camera, points: np.ndarray) -> None:
    small = 4e-3 if camera.model.parallel else 1.0  # its field is less than a millimetre
    step = 1e-3 * small
    slopes = [
        (camera.project(points + step * axis).q - camera.project(points - step * axis).q) / (2 * step)
        for axis in np.eye(3)
    ]
    found = camera.point_jacobian(points)
    np.testing.assert_allclose(found, np.stack(slopes, axis=-1), rtol=0, atol=2e-8 / small)


def test_the_intrinsic_jacobian_is_the_slope(camera: Camera, points: np.ndarray) -> None:
    count = lens_by_name(camera.lens).coefficients
    found = camera.intrinsic_jacobian(points)
    assert found.shape == (len(points), 2, 4 + count)

    def moved(number: int, step: float) -> np.ndarray:
        K, dist = camera.K.copy(), camera.dist.copy()
        if number < 4:
            row, column = ((0, 0), (1, 1), (0, 2), (1, 2))[number]
            K[row, column] += step
        else:
            dist[number - 4] += step
        return Camera(K, camera.lens, dist, camera.T_cam_world, camera.size).project(points).q

    for number in range(4 + count):
        step = 1e-2 if number < 4 else 1e-5
        slope = (moved(number, step) - moved(number, -step)) / (2 * step)
        np.testing.assert_allclose(found[..., number], slope, rtol=0, atol=1e-6, err_msg=str(number))


@pytest.mark.parametrize("z", [0.0, -1.0, -500.0])
def test_nothing_behind_the_camera_is_imaged(z: float) -> None:
    found = Camera(K, "pinhole", PLAIN, IDENTITY, (640, 480)).project(np.array([[0.0, 0.0, z], [0, 0, 1]]))
    np.testing.assert_array_equal(found.ok, [False, True])
    assert np.isnan(found.q[0]).all()


def test_nan_goes_through_as_not_ok(camera: Camera) -> None:
    missing = np.array([[np.nan, 0.0, 500.0], [np.nan, np.nan, np.nan]])
    assert not camera.project(missing).ok.any()
    rays = camera.rays(missing[:, :2])
    assert not rays.ok.any()
    assert np.isnan(rays.origin).all()
    assert np.isnan(rays.direction).all()


def test_beyond_the_fold_nothing_is_imaged() -> None:
    camera = barrel(400.0)
    radii = np.array([0.99, 1.01, 3.0]) * FOLD
    angle = np.linspace(0, 2 * np.pi, 7)[:, None]
    p = np.stack([radii * np.cos(angle), radii * np.sin(angle), np.ones((7, 3))], axis=-1)
    found = camera.project(p)
    np.testing.assert_array_equal(found.ok, [[True, False, False]] * 7)
    assert np.isnan(found.q[:, 1:]).all()


def test_pixels_beyond_the_fold_see_nothing() -> None:
    camera = barrel(400.0)
    angle = np.linspace(0, 2 * np.pi, 7)[:, None]
    radii = np.array([0.999, 1.001, 1.4]) * FOLD_IMAGE * 400
    q = np.stack([319.5 + radii * np.cos(angle), 239.5 + radii * np.sin(angle)], axis=-1)
    rays = camera.rays(q)
    np.testing.assert_array_equal(rays.ok, [[True, False, False]] * 7)
    ideal = np.hypot(rays.direction[:, 0, 0], rays.direction[:, 0, 1]) / rays.direction[:, 0, 2]
    np.testing.assert_allclose(ideal * (1 - 0.3 * ideal**2), 0.999 * FOLD_IMAGE, atol=1e-9)
    assert (ideal < FOLD).all()


def test_a_lens_that_folds_within_the_picture_is_refused() -> None:
    corner = np.hypot(320, 240)
    require_rays_everywhere("left", barrel(1.001 * corner / FOLD_IMAGE))
    with pytest.raises(InputError, match=r"camera 'left' \(brown5\) folds within its picture: pixel"):
        require_rays_everywhere("left", barrel(0.999 * corner / FOLD_IMAGE))


def test_the_picture_reaches_half_a_pixel_beyond_the_outer_centres() -> None:
    camera = Camera(K, "pinhole", PLAIN, IDENTITY, (640, 480))
    q = np.array([[-0.5, 0], [639.5, 479.5], [-0.51, 0], [0, 479.51], [np.nan, 3]])
    np.testing.assert_array_equal(camera.in_picture(q), [True, True, False, False, False])


def changed(row: int, column: int, value: float) -> np.ndarray:
    matrix = K.copy()
    matrix[row, column] = value
    return matrix


@pytest.mark.parametrize(
    ("matrix", "lens", "dist", "size", "said"),
    [
        (changed(0, 1, 0.1), "brown5", PLAIN, (640, 480), "K must be"),
        (changed(0, 0, -700.0), "brown5", PLAIN, (640, 480), "positive focal lengths"),
        (changed(0, 2, np.nan), "brown5", PLAIN, (640, 480), "K must be"),
        (K, "brown5", np.zeros(4), (640, 480), "at least 5"),
        (K, "brown5", np.full(5, np.inf), (640, 480), "finite"),
        (K, "brown-k1k2", np.array([0, 0, 1e-3, 0, 0.0]), (640, 480), "'brown-k1k2' has 2 coefficients"),
        (K, "pinhole", FOLDED, (640, 480), "'pinhole' has 0"),
        (K, "brown5", PLAIN, (0, 480), "0 x 480"),
    ],
)
def test_impossible_cameras_are_refused(
    matrix: np.ndarray, lens: str, dist: np.ndarray, size: tuple[int, int], said: str
) -> None:
    with pytest.raises(InputError, match=said):
        Camera(matrix, lens, dist, IDENTITY, size)


def test_an_unknown_lens_offers_the_nearest() -> None:
    with pytest.raises(UnknownNameError, match="'brown5'"):
        Camera(K, "brown6", PLAIN, IDENTITY, (640, 480))
