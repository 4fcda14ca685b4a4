"""The mesh of a bent board as rays meet it, against the surface that the truth takes."""

import numpy as np

from labcal.geometry.poses import inverse, transform
from labcal.render.laboratory import Laboratory
from labcal.render.variant import MONO, renderer
from labcal.scene.catalogue import load_scene
from labcal.scene.surface import Surface
from labcal.scene.views import planned_views


def test_rays_meet_the_mesh_where_the_surface_is_with_uv_of_its_place() -> None:
    bend = ("board.bend.along_x_mm=12", "board.bend.along_y_mm=-8", "board.bend.twist_mm=5")
    scene = load_scene("webcam-handheld", ("photometry.bayer=off", *bend))
    view, camera = planned_views(scene, 0)[0], scene.true_cameras()["left"]
    surface = Surface.of(scene.target, scene.board.bend)
    wanted = np.random.default_rng(2).uniform(-0.999, 0.999, (20_000, 2)) * surface.half + surface.middle
    eye = transform(inverse(view.T_world_target), camera.centre)
    way = surface.points(wanted) - eye
    world = way @ view.T_world_target[:3, :3].T
    with renderer(MONO) as mi:
        laboratory = Laboratory(mi, scene, camera.size, 0)
        laboratory.place(view.T_world_target)
        origin = mi.Point3f(*(float(x) for x in camera.centre))
        ray = mi.Ray3f(origin, mi.Vector3f(*(mi.Float(x) for x in world.T.astype(np.float32))))
        si = laboratory.scene.ray_intersect(ray)
        found, uv = np.array(si.t, np.float64), np.array(si.uv, np.float64).T
        normals = np.array(si.sh_frame.n, np.float64).T
    hidden = surface.hides(eye[None], wanted)
    assert hidden.mean() < 0.01
    met = eye + found[:, None] * way
    np.testing.assert_array_less(np.linalg.norm(met - surface.points(wanted), axis=1)[~hidden], 1.5e-3)
    place = surface.middle + (2.0 * uv - 1.0) * surface.half
    np.testing.assert_array_less(np.linalg.norm(place - wanted, axis=1)[~hidden], 1.5e-3)
    expected = surface.normals(wanted) @ view.T_world_target[:3, :3].T
    np.testing.assert_allclose(normals[~hidden], expected[~hidden], atol=1e-4)
