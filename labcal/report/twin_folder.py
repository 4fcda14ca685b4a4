"""The folder of a twin: document, page, pictures, and a shoot of its own with truth."""

from pathlib import Path

import numpy as np

from labcal.cameras.dot_image import dot_images
from labcal.cameras.record import CameraRecord, matrix4_record
from labcal.geometry.poses import transform
from labcal.guide.twin.picture import SHOOT
from labcal.guide.twin.twin import Twin
from labcal.report.page.document import INNER_PAGE_KIND
from labcal.report.page_maker import PageMaker
from labcal.report.twin_page import twin_page
from labcal.report.twin_result import twin_result
from labcal.run.json_text import to_json
from labcal.run.outputs import write_file
from labcal.shoot.dataset import write_manifest
from labcal.shoot.manifest import CameraEntry, Manifest, Role, ViewEntry
from labcal.shoot.raw_pictures import RawFormat
from labcal.shoot.truth import TrueDots, TrueView, Truth, write_truth

DOCUMENT, PAGE = "twin.json", "index.html"


def write_twin(folder: Path, found: Twin, maker: PageMaker, raw: RawFormat | None = None) -> None:
    """Write all files of a twin but the pictures, which are there already.

    Parameters
    ----------
    folder : Path
    found : Twin
    maker : PageMaker
    raw : RawFormat, optional
        Pixel format of the photographs, where their files do not tell it.
    """
    result = twin_result(".", found)
    write_file(folder / DOCUMENT, to_json(result), force=True)
    _write_shoot(folder / SHOOT, found)
    page = twin_page(result, folder, maker, raw).text()
    write_file(folder / PAGE, page, kind=INNER_PAGE_KIND, force=True)


def _write_shoot(folder: Path, found: Twin) -> None:
    """Write manifest and truth of the renderings with noise, so that every command runs on them."""
    posed = found.posed
    cameras = dict(zip(posed.cameras, posed.state.cameras, strict=True))
    poses = dict(zip(posed.names, posed.state.T_world_target, strict=True))
    views: dict[str, dict[str, str]] = {}
    for made in found.pictures:
        views.setdefault(made.view, {})[made.camera] = f"images/{made.view}_{made.camera}.png"
    whole = {name: images for name, images in views.items() if set(images) == set(cameras)}
    views = whole or views
    shown = {camera for images in views.values() for camera in images}
    write_manifest(
        folder,
        Manifest(
            target=found.known.target,
            cameras={name: CameraEntry(size=one.size) for name, one in cameras.items() if name in shown},
            views=tuple(
                ViewEntry(name=name, images=images, role=Role.TRAIN, T_world_target_nominal=None)
                for name, images in views.items()
            ),
        ),
    )
    truth = Truth(
        cameras={name: CameraRecord.of(one) for name, one in cameras.items() if name in shown},
        views={name: TrueView(T_world_target=matrix4_record(poses[name])) for name in views},
    )
    target, dots = found.known.target, found.known.dots
    radii = 0.5 * target.outer_diameters_mm()
    pictures = []
    for name, images in views.items():
        for camera in images:
            seen = dot_images(cameras[camera], poses[name], dots, radii)
            inside = seen.ok & np.asarray(cameras[camera].in_picture(seen.outline)).all(axis=-1)
            pictures.append(
                TrueDots(
                    name,
                    camera,
                    target.indices(),
                    transform(poses[name], dots),
                    seen.centre,
                    seen.centroid,
                    inside,
                )
            )
    write_truth(folder, truth, pictures)
