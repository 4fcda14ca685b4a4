"""A page with a picture of every scene, for comparison with photographs."""

from pathlib import Path
from tempfile import TemporaryDirectory

from labcal.paths import AnyPath, as_path
from labcal.render.shoot import RenderSettings, render_shoot
from labcal.report.thumbnail import thumbnail
from labcal.run.outputs import write_file
from labcal.run.progress import NoProgress, Progress
from labcal.run.unfinished import unfinished_folder
from labcal.scene.catalogue import load_scene, scene_names
from labcal.shoot.pictures import read_picture, write_picture

WIDTH = 640
"""Of the pictures on the page, px."""
QUALITY = 88


def make_gallery(folder: AnyPath, seed: int, progress: Progress, *, force: bool = False) -> list[str]:
    """Render the first view of every shipped scene and write ``README.md`` with the pictures.

    Parameters
    ----------
    folder : str or os.PathLike
        It appears when every picture is there.
    seed : int
    progress : Progress
        Notified of every scene.
    force : bool
        Replace a folder that is there.

    Returns
    -------
    list of str
        The scenes.

    Raises
    ------
    OutputError
        The folder exists and `force` is not set.
    DeviceError
        There is no LLVM library for the renderer.
    """
    folder = as_path(folder)
    names = scene_names()
    progress.start("gallery", len(names))
    lines = [
        "# The scenes that labcal ships",
        "",
        "Made by `labcal scene gallery -o docs/gallery --force`.",
        "",
    ]
    with unfinished_folder(folder, f"scene gallery {seed}", force=force) as working:
        for name in names:
            scene = load_scene(name)
            with TemporaryDirectory() as home:
                settings = RenderSettings(views=1, seed=seed)
                shoot = render_shoot(scene, Path(home) / "shoot", settings, NoProgress())
                view = shoot.views()[0]
                camera, image = next(iter(view.images.items()))
                small = thumbnail(read_picture(shoot.folder / image), WIDTH, WIDTH)
            write_picture(working / f"{name}.jpg", small, jpeg_quality=QUALITY, force=True)
            caption = f"{view.name}, camera {camera}"
            lines += [f"## {name}", "", scene.description, "", f"![{name}: {caption}]({name}.jpg)", ""]
            progress.advance()
        write_file(working / "README.md", "\n".join(lines), force=True)
    return names
