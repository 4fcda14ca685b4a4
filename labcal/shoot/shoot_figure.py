"""A figure of a shoot: its pictures, small."""

import numpy as np
from matplotlib.figure import Figure

from labcal.shoot.dataset import Shoot
from labcal.shoot.pictures import read_picture

_MOST_VIEWS = 12
_SIDE_PX = 240


def shoot_figure(shoot: Shoot) -> Figure:
    """Draw the pictures of a shoot, a line a view; see :meth:`Shoot.plot`."""
    every = shoot.views()
    chosen = [every[at] for at in np.unique(np.linspace(0, len(every) - 1, _MOST_VIEWS).astype(int))]
    cameras = shoot.cameras
    figure = Figure(figsize=(2.6 * len(cameras), 2.0 * len(chosen)), layout="constrained")
    for line, view in enumerate(chosen):
        for column, camera in enumerate(cameras):
            axes = figure.add_subplot(len(chosen), len(cameras), line * len(cameras) + column + 1)
            axes.set_xticks([])
            axes.set_yticks([])
            axes.set_title(f"{view.name}, {camera} ({view.role.value})", fontsize="small")
            if camera in view.images:
                axes.imshow(_small(read_picture(shoot.folder / view.images[camera])), cmap="gray")
            else:
                axes.text(0.5, 0.5, "no picture", ha="center", va="center", transform=axes.transAxes)
    figure.suptitle(f"{len(chosen)} of {len(every)} views; each picture in its own range of grey")
    return figure


def _small(picture: np.ndarray) -> np.ndarray:
    """Return every n-th pixel of a picture, scaled to 0 to 1."""
    step = max(1, max(picture.shape[:2]) // _SIDE_PX)
    small = picture[::step, ::step].astype(np.float64)
    low, high = float(small.min()), float(small.max())
    return (small - low) / (high - low) if high > low else np.zeros_like(small)
