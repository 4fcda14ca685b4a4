"""Small valid files of every kind that labcal reads."""

import shutil
from pathlib import Path

import cv2
import numpy as np

from labcal.cameras.camera import Camera
from labcal.cameras.dot_image import dot_images
from labcal.cameras.interop.exchange import Home
from labcal.cameras.interop.registry import FORMATS
from labcal.cameras.interop.rig_files import write_rig_files
from labcal.cameras.rig import Rig
from labcal.cameras.rig_covariance import RigCovariance, parameter_names
from labcal.cameras.rig_file import write_rig
from labcal.cameras.window import FlatWindow
from labcal.correspond.detections import Detections
from labcal.correspond.detections_csv import detections_csv
from labcal.correspond.interop.corners_vnl import corners_text
from labcal.correspond.named_pixels import NamedPixels
from labcal.correspond.named_pixels_csv import pixels_csv
from labcal.correspond.points_csv import points_csv
from labcal.estimators.camera_estimator import CameraEstimator
from labcal.estimators.model import Model, TrainingBox
from labcal.estimators.model_file import save_model
from labcal.estimators.networks.mlp import Mlp
from labcal.estimators.networks.mlp_bayes import MlpBayes
from labcal.estimators.networks.ray_net import RayNet
from labcal.estimators.registry import make_estimator, method_names
from labcal.geometry.poses import from_rotation_vector, look_at
from labcal.reconstruct.reconstruction import reconstruct_points
from labcal.run.json_text import to_json
from labcal.shoot.dataset import write_manifest
from labcal.shoot.exr import write_exr
from labcal.shoot.manifest import CameraEntry, Manifest, ViewEntry
from labcal.shoot.truth import TrueDots, TrueView, Truth, write_truth
from labcal.targets.grid import DotGrid, Rings
from labcal.targets.places import DotPlaces, write_places

SIZE = (640, 480)
TARGET = DotGrid(
    name="small", cols=6, rows=5, pitch_x_mm=20.0, pitch_y_mm=20.0, dot_diameter_mm=8.0,
    ring_outer_diameter_mm=12.0, ring_inner_diameter_mm=5.0,
    rings=Rings(origin=(1, 1), x=(4, 1), y=(1, 3)), margin_mm=15.0,
)  # fmt: skip
TARGET_YAML = """name: small
description: a small one
cols: 6
rows: 5
pitch_x_mm: 20.0
pitch_y_mm: 20.0
dot_diameter_mm: 8.0
ring_outer_diameter_mm: 12.0
ring_inner_diameter_mm: 5.0
polarity: black-on-white
rings: {origin: [1, 1], x: [4, 1], y: [1, 3]}
margin_mm: 15.0
"""
SCENE_YAML = """name: bench
description: a pair of cameras above a stage
target: rings-10x8
cameras:
  left:
    size: [640, 480]
    focal_px: 700.0
    principal_px: [322.4, 237.1]
    lens: brown5
    dist: [-0.1, 0.03, 0.0006, -0.0004, 0.0]
    eye_mm: [-40.0, -10.0, 250.0]
    look_at_mm: [16.0, 12.0, 0.0]
  right:
    size: [640, 480]
    focal_px: 704.0
    lens: brown5
    dist: [-0.1, 0.03]
    window: {kind: flat, distance_mm: 20.0, tilt_x_deg: 3.0, thickness_mm: 3.0}
    aperture: {diameter_mm: 2.0, focus_mm: 250.0}
    eye_mm: [70.0, -10.0, 250.0]
    look_at_mm: [16.0, 12.0, 0.0]
placement:
  kind: stage
  views:
    - {name: train, role: train, origin_mm: [0.0, 0.0, 0.0]}
    - {name: test, role: test, origin_mm: [0.0, 0.0, 5.0], shift_pitches: [0.5, 0.5]}
lamps:
  - {centre_mm: [-100.0, 100.0, 900.0], look_at_mm: [0.0, 0.0, 0.0], size_mm: [200.0, 200.0], radiance: 9.0}
  - {kind: spot, centre_mm: [90.0, 100.0, 900.0], look_at_mm: [0.0, 0.0, 0.0], intensity: 1000.0,
     beam_deg: 20.0, cutoff_deg: 30.0}
  - {kind: ambient, radiance: 0.04}
room: {floor_z_mm: -800.0, wall_y_mm: 2600.0, table_centre_mm: [0.0, 0.0]}
board: {thickness_mm: 8.0, misplacement_mm: 0.01, bend: {along_x_mm: 0.1}}
occluders:
  - {kind: rod, from_mm: [200.0, 0.0, 0.0], to_mm: [200.0, 0.0, 50.0], diameter_mm: 5.0}
photometry: {preset: webcam-2000, jpeg_quality: 90}
motion: {velocity_mm_s: [1.0, 0.0, 0.0]}
spp: 4
"""
LENS_YAML = """name: doublet
surfaces:
  - {radius_mm: null, gap_mm: 1.133, index: 1.0, diameter_mm: 1.04}
  - {radius_mm: -8.636, gap_mm: 1.361, index: 1.4914, diameter_mm: 3.0}
  - {radius_mm: -2.982, gap_mm: 0.669, index: 1.0, diameter_mm: 3.8}
  - {radius_mm: 6.980, gap_mm: 0.777, index: 1.585, diameter_mm: 4.6}
  - {radius_mm: -11.850, gap_mm: 3.632, index: 1.0, diameter_mm: 4.8}
stop: 0
"""
CHARUCO_YAML = """kind: charuco
name: board
squares: [5, 4]
square_mm: 20.0
marker_mm: 15.0
dictionary: DICT_5X5_100
pattern: current
margin_mm: 10.0
"""
BOARDS_YAML = """name: plate
targets:
  - {kind: charuco, name: a, squares: [5, 4], square_mm: 20.0, marker_mm: 15.0, dictionary: DICT_5X5_100}
  - {kind: chessboard, name: b, cols: 9, rows: 6, square_mm: 25.0}
mounting: rigid
"""
VIC_3D = """<project dir="C:/CalA">
 <calibration lri="calibration">
  <camera id="0">638 407 2468.5 2468.25 0 0 0 0<orientation>180 9 0 -63 -0.5 18</orientation></camera>
  <camera id="1">628 394 2377 2376 0 0 0 0<orientation>-180 -9 0 64 -0.5 15</orientation></camera>
 </calibration>
<projectaois><aoinode><polygonmask width="1280" height="800"></polygonmask></aoinode></projectaois>
</project>
"""


def rig_cameras() -> dict[str, Camera]:
    """Return a pair with mild distortion."""
    cameras = {}
    for name, x, focal in (("left", -150.0, 900.0), ("right", 150.0, 910.0)):
        T = look_at(np.array([x, 0.0, 800.0]), np.array([50.0, 40.0, 0.0]), np.array([0.0, 1.0, 0.0]))
        K = np.array([[focal, 0.0, 321.0], [0.0, focal + 1.0, 238.0], [0.0, 0.0, 1.0]])
        cameras[name] = Camera(K, "brown5", np.array([-0.1, 0.02, 0.0, 0.0, 0.0]), T, SIZE)
    return cameras


def view_poses(count: int) -> dict[str, np.ndarray]:
    """Return poses of the target, every one tilted another way."""
    return {
        f"v{i}": from_rotation_vector(
            np.array([0.5 * np.cos(i), 0.5 * np.sin(2.0 * i), 0.3 * i]),
            np.array([3.0 * i, -2.0 * i, 15.0 * i]),
        )
        for i in range(count)
    }


def seen(cameras: dict[str, Camera], poses: dict[str, np.ndarray]) -> tuple[Detections, list[TrueDots]]:
    """Return what a good detector measures, and the truth."""
    rng = np.random.default_rng(5)
    columns: dict[str, list[np.ndarray]] = {}
    truth = []
    n = TARGET.count
    for view, T in poses.items():
        world = TARGET.points() @ T[:3, :3].T + T[:3, 3]
        for name, camera in cameras.items():
            found = dot_images(camera, T, TARGET.points(), 0.5 * TARGET.outer_diameters_mm())
            truth.append(
                TrueDots(view, name, TARGET.indices(), world, found.centre, found.centroid, found.ok)
            )
            part = {
                "view": np.full(n, view, dtype="<U8"),
                "camera": np.full(n, name, dtype="<U8"),
                "image": np.full(n, f"{view}_{name}.png", dtype="<U32"),
                "size": np.tile(np.array(SIZE, dtype=np.int64), (n, 1)),
                "index": TARGET.indices().astype(np.int64),
                "has_id": np.ones(n, dtype=bool),
                "position": found.centroid + rng.normal(scale=0.02, size=(n, 2)),
                "covariance": np.tile(4e-4 * np.eye(2), (n, 1, 1)),
                "flag": np.where(found.ok, "ok", "cut"),
            }
            for key, values in part.items():
                columns.setdefault(key, []).append(values)
    return Detections(**{key: np.concatenate(parts) for key, parts in columns.items()}), truth


def _models(home: Path, cameras: dict[str, Camera]) -> None:
    grid = np.meshgrid(np.linspace(-40, 60, 6), np.linspace(-40, 60, 5), np.linspace(-30, 60, 4))
    volume = np.stack([axis.ravel() for axis in grid], axis=1)
    plane = volume[volume[:, 2] == volume[0, 2]]
    for name in method_names():
        p = plane if name == "homography" else volume
        X = np.concatenate([camera.project(p).q for camera in cameras.values()], axis=1)
        X += np.random.default_rng(1).normal(scale=0.02, size=X.shape)
        estimator = make_estimator(name)
        if isinstance(estimator, Mlp | MlpBayes | RayNet):
            estimator.set_params(hidden=(4, 5), max_epochs=4, restarts=1)
        if isinstance(estimator, CameraEstimator):
            estimator.set_params(lens="brown-k1k2", image_sizes=(SIZE, SIZE))
        estimator.fit(X, p)
        model = Model(estimator, tuple(cameras), (SIZE, SIZE), TrainingBox.of(X, p))
        save_model(home / f"{name}.safetensors", model, force=True)


def _pictures(home: Path) -> None:
    grey = np.full((96, 128), 200, dtype=np.uint8)
    for col in range(6):
        for row in range(4):
            cv2.circle(grey, (16 + 18 * col, 16 + 20 * row), 6, 20, -1, cv2.LINE_AA)
    for ending in ("png", "jpg", "bmp", "tif", "pgm", "webp"):
        (home / f"p.{ending}").write_bytes(cv2.imencode(f".{ending}", grey)[1].tobytes())
    (home / "frame_left.png").write_bytes(
        cv2.imencode(".png", np.full(SIZE[::-1], 90, dtype=np.uint8))[1].tobytes()
    )
    strips = [cv2.IMWRITE_TIFF_COMPRESSION, 5, cv2.IMWRITE_TIFF_ROWSPERSTRIP, 2]
    (home / "strips.tif").write_bytes(cv2.imencode(".tif", np.dstack([grey] * 3), strips)[1].tobytes())
    write_exr(home / "p.exr", grey.astype(np.float32) / 255.0, {"labcal:picture": "{}"}, force=True)


def _named(home: Path, detections: Detections) -> None:
    """Write named pixels, the points that determine a frame, and tables of pixels of other programs."""
    few = detections.where((detections.view == detections.view[0]) & detections.ok)
    names = [f"{col}-{row}" for col, row in few.index.tolist()]
    pixels = NamedPixels(few.view, few.camera, names, few.position, few.covariance)
    (home / "pixels.csv").write_text(pixels_csv(pixels), encoding="utf-8")
    lines = [f"{col}-{row},{20 * col},{20 * row},0,0.01" for col, row in ((0, 0), (5, 0), (0, 4), (5, 4))]
    known = "\n".join(["point,X_mm,Y_mm,Z_mm,sigma_mm", *lines]) + "\n"
    dlc = "scorer,a,a,a\nbodyparts,paw,paw,paw\ncoords,x,y,likelihood\n0,10.5,20.5,0.9\n1,11.5,21.5,0.8\n"
    tracks = "# IMAGE_ID\n1 1 0 0 0 0 0 0 1 a_left.png\n100.5 50.5 7 3 4 -1 20.25 30.5 9\n"
    vic = '"sigma", "x", "y", "u", "v", "q", "r"\n0.01, 100, 50, 0.25, 0.5, -40.5, 1.25\n'
    view, ends = str(few.view[0]), ((0, 5), (0, 3), (2, 4))
    rows = [
        f"1,{one + other},{view},{one}-0,{view},{other}-0,{20 * (other - one)},0.01" for one, other in ends
    ]
    header = "line,length,view_a,point_a,view_b,point_b,nominal_mm,sigma_mm"
    (home / "lengths.csv").write_text("\n".join([header, *rows]) + "\n", encoding="utf-8")
    texts = {"known.csv": known, "dlc.csv": dlc, "tracks.txt": tracks, "vic.csv": vic}
    for name, text in texts.items():
        (home / name).write_text(text, encoding="utf-8")


def make_seeds(home: Path) -> Path:
    """Write all seeds into a new folder and return it."""
    home.mkdir(parents=True)
    for name, text in {
        "target.yaml": TARGET_YAML, "charuco.yaml": CHARUCO_YAML, "boards.yaml": BOARDS_YAML,
        "scene.yaml": SCENE_YAML,
        "lens.yaml": LENS_YAML, "vic3d.xml": VIC_3D, "tone.csv": "value,light\n0,0\n0.2,0.1\n0.6,0.5\n1,1\n",
        "asymmetric.yaml": "name: a\nlayout: asymmetric\ncols: 4\nrows: 11\npitch_x_mm: 40.0\n"
        "pitch_y_mm: 20.0\ndot_diameter_mm: 12.0\nrings: null\n",
        "photometry.yaml": "{bayer: true, exposure_ms: 10.0, full_well_e: 20000.0, prnu: 0.01, dsnu_e: 2.0, "
        "read_noise_e: 6.0, black_level_dn: 10.0, adc_bits: 12, tone_curve: srgb, format: png, bits: 16}",
        "handheld.yaml": "{kind: handheld, train: 2, test: 0, centre_mm: [0.0, 0.0, 0.0], "
        "spread_mm: [5.0, 5.0, 5.0], tilt_max_deg: 20.0}",
        "volume.yaml": "{kind: volume, origin_mm: [0.0, 0.0], heights_mm: [0.0, 5.0], train: 2, test: 1}",
        "planes.yaml": "{kind: planes, origin_mm: [0.0, 0.0], heights_mm: {first: 0.0, last: 4.0, count: 2}}",
    }.items():  # fmt: skip
        (home / name).write_text(text, encoding="utf-8")
    cameras = rig_cameras()
    rig = Rig.of(cameras)
    count = len(parameter_names(rig.cameras))
    stated = RigCovariance.of(rig.cameras, np.diag(np.full(count, 1e-8)) + 1e-9)
    write_rig(home / "rig.json", rig.model_copy(update={"covariance": stated}))
    windowed = {
        name: Camera(
            one.K, one.lens, one.dist, one.T_cam_world, one.size, window=FlatWindow(distance_mm=50.0)
        )
        for name, one in cameras.items()
    }
    write_rig(home / "windowed.json", Rig.of(windowed))
    for name, made in FORMATS.items():
        folder = home / "formats" / name
        folder.mkdir(parents=True)
        path = folder if made.home is Home.FOLDER else folder / f"rig{made.suffixes[0]}"
        write_rig_files(path, made, made.write(rig, made.suffixes[0]), force=True)
    opencv = FORMATS["opencv"]
    for ending in (".xml",):
        write_rig_files(home / f"rig{ending}", opencv, opencv.write(rig, ending), force=True)
    poses = view_poses(5)
    detections, truth = seen(cameras, poses)
    (home / "detections.csv").write_text(detections_csv(detections), encoding="utf-8")
    (home / "corners.vnl").write_text(corners_text(detections, TARGET).text, encoding="utf-8")
    points = reconstruct_points(rig, detections, TARGET)
    (home / "points.csv").write_text(points_csv(points), encoding="utf-8")
    _named(home, detections)
    n = TARGET.count
    places = DotPlaces.of(
        TARGET, TARGET.points(), np.tile(1e-6 * np.eye(3), (n, 1, 1)), np.full(n, 5), np.ones(n, dtype=bool)
    )
    write_places(home / "rig-dots.json", places)
    shoot = home / "shoot"
    shoot.mkdir()
    record = {view: tuple(map(tuple, T.tolist())) for view, T in poses.items()}
    write_manifest(
        shoot,
        Manifest(
            target=TARGET,
            cameras={name: CameraEntry(size=SIZE) for name in cameras},
            views=tuple(
                ViewEntry(
                    name=view,
                    images={name: f"images/{view}_{name}.png" for name in cameras},
                    role="train" if number < 3 else "test",
                    T_world_target_nominal=record[view],
                )
                for number, view in enumerate(poses)
            ),
        ),
    )
    write_truth(
        shoot,
        Truth(cameras=rig.cameras, views={view: TrueView(T_world_target=T) for view, T in record.items()}),
        truth,
    )
    _models(home, cameras)
    _pictures(home)
    (home / "results").mkdir()
    (home / "results" / "results.json").write_text(to_json(_results()), encoding="utf-8")
    shutil.copy(home / "p.png", home / "results" / "a.png")
    return home


def _claim() -> dict[str, object]:
    compared = {
        "where": "a plane", "of": "one", "over": "1.0", "figure": "rmse_mm", "statement": "at most",
        "factor": 1.25, "pairs": 10, "ratio": 1.1, "interval": [1.0, None], "p": 0.01, "supported": True,
    }  # fmt: skip
    return {
        "claim": "C1", "text": "a", "expected": "b", "verdict": "holds", "where": [], "effect": 1.1,
        "interval": [1.0, 1.2], "p": 0.01, "adjusted_p": 0.02, "comparisons": [compared],
    }  # fmt: skip


def _results() -> dict[str, object]:
    figures = {
        "reading": "mlp", "mean_signed_m": 1e-5, "rel": 1e-5, "mae_mm": 0.1, "rmse_mm": 0.2, "p95_mm": 0.3,
        "max_mm": 0.5, "epochs": 20.0, "goal_reached": True, "seconds": 0.5,
        "mean_signed_range_m": [0.0, 2e-5], "mae_range_mm": [0.1, 0.2], "rmse_range_mm": [0.2, 0.3],
        "p95_range_mm": [0.2, 0.4], "max_range_mm": [0.4, 0.6], "epochs_range": [18.0, 22.0],
        "seconds_range": [0.4, 0.6],
    }  # fmt: skip
    row = {
        **figures, "exp": "01", "solver": "network", "data": "simulated", "points": 100, "network": "4-20-3",
        "goal": 1e-6, "seeds": 5, "paper_epochs": 30, "paper_abs_m": 1e-4, "paper_rel": 1e-4,
        "verdict": "matches", "contradiction": None, "readings": [figures],
    }  # fmt: skip
    return {
        "rows": [row], "not_reported": ["99"], "claims": [_claim()], "claims_plan_sha256": "00",
        "quick": True, "restrictions": ["few"],
        "pictures": [{"scene": "webcam-plane", "caption": "left", "file": "a.png"}],
    }  # fmt: skip
