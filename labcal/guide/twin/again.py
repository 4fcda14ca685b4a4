"""A photograph rendered again, with its own light, blur and noise."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float32, Int64

from labcal.arrays import Pose
from labcal.cameras.camera import Camera
from labcal.cameras.dot_image import dot_images
from labcal.correspond.sources import Source
from labcal.errors import InputError
from labcal.guide.twin.dot_windows import BlurredShare, DotWindows, Windows, dot_windows
from labcal.guide.twin.jpeg_coding import JpegCoding
from labcal.guide.twin.known_print import KnownPrint
from labcal.guide.twin.light import PictureLight, fitted_light
from labcal.guide.twin.mosaic import behind_mosaic, green_behind_mosaic
from labcal.guide.twin.noise import PictureNoise, measured_noise
from labcal.guide.twin.ray_noise import ray_variance, with_lamps
from labcal.guide.twin.region import compared_pixels
from labcal.guide.twin.scene import still_take, twin_scene
from labcal.guide.twin.stored import StoredValues
from labcal.render.irradiance import Case
from labcal.render.paper_share import EdgeRays, PaperShare, paper_share
from labcal.rng import generator
from labcal.shoot.tone_curve import ToneCurve

FIRST_BLUR_PX = 0.8
_LEAST_BLUR_PX, _MOST_BLUR_PX = 0.15, 12.0
_ROUNDS = 6
_SETTLED_PX = 0.004
_LIKE = 1.1
"""Ratio of blurs from which on light and noise are fitted anew, since fewer pixels show one colour."""
BLUR, GROWTH = 4, 5
"""Columns of the parameters of a dot's window."""
_PURE = 1e-3
_MORE_SIGMAS = 3.0


@dataclass(frozen=True)
class TwinJob:
    """One picture to be compared, and everything that determines the outcome.

    Attributes
    ----------
    source : Source
    known : KnownPrint
    camera : Camera
        The camera's name is that of the source.
    T_world_target : float64 array, (4, 4)
        Mm.
    dots : int array, (n,)
        Numbers of the dots that were measured in the photograph.
    curve : ToneCurve
    spp, draws, seed : int
    rays : int or None
        Rays a pixel of the photograph, where it is a rendering that says so.
    lamp_variance : float
        Of the light of one such ray by the choice of lamps, over the square of its mean.
    has_mosaic : bool
        True if the photograph is a rendering through a Bayer mosaic.
    folder : Path or None
        Where pictures are written: ``rendering``, ``difference`` and ``images``; None for none.
    name : str
        Of the file.
    """

    source: Source
    known: KnownPrint
    camera: Camera
    T_world_target: Pose
    dots: Int64[np.ndarray, " n"]
    curve: ToneCurve
    spp: int
    draws: int
    seed: int
    rays: int | None
    lamp_variance: float
    has_mosaic: bool
    folder: Path | None
    name: str


@dataclass(frozen=True)
class RenderedAgain:
    """A photograph and its rendering, in light.

    Attributes
    ----------
    stored : StoredValues
    photo : list of float32 array, (h, w)
        Light of each channel.
    light : list of PictureLight
    noise : list of PictureNoise
    blur_px : float
    behind : BlurredShare
    compared : bool array, (h, w)
    windows : DotWindows
        Of the main channel.
    around : Windows
        Where they are.
    made : PaperShare
        As it was rendered, sharp.
    coded : list of float32 array, (h, w)
        Variance of each channel after compression, in place of that by light and rays; none where there is no
        compression.
    before_coding : float
        Variance of the noise before compression over the one that is left after it.
    has_mosaic : bool
        True if light passes a Bayer mosaic.
    """

    stored: StoredValues
    photo: list[Float32[np.ndarray, "h w"]]
    light: list[PictureLight]
    noise: list[PictureNoise]
    blur_px: float
    behind: BlurredShare
    compared: Bool[np.ndarray, "h w"]
    windows: DotWindows
    around: Windows
    made: PaperShare
    coded: list[Float32[np.ndarray, "h w"]] = field(default_factory=list)
    before_coding: float = 1.0
    has_mosaic: bool = False

    @property
    def main(self) -> int:
        """The channel that tells blur and places: green, or the only one."""
        return min(1, len(self.photo) - 1)

    def clean(self) -> list[Float32[np.ndarray, "h w"]]:
        """Return the light of the rendering, without noise."""
        light = self._delivered([light.image(self.behind.share) for light in self.light])
        return self.stored.sampled(light)

    def seen(self) -> BlurredShare:
        """Return the share of paper that the main channel shows: behind blur and mosaic."""
        return green_behind_mosaic(self.behind) if self.has_mosaic else self.behind

    def _delivered(self, light: list[Float32[np.ndarray, "h w"]]) -> list[Float32[np.ndarray, "h w"]]:
        if not self.has_mosaic:
            return light
        return [np.clip(one, 0.0, self.stored.top) for one in behind_mosaic(light)]

    def variances(self) -> list[Float32[np.ndarray, "h w"]]:
        """Return the variance of the noise of each channel: by light, rays, and compression."""
        if self.coded:
            return self.coded
        by_rays = ray_variance(self.made, self.blur_px)
        found = []
        for light, noise in zip(self.light, self.noise, strict=True):
            contrast = light.paper.over(by_rays.shape) - light.ink.over(by_rays.shape)
            found.append(_least(noise, light.image(self.behind.share), self.stored) + contrast**2 * by_rays)
        return found

    def noisy(self, number: int, random: np.random.Generator) -> np.ndarray:
        """Return the picture that the twin takes, with noise that is drawn.

        Parameters
        ----------
        number : int
            Of the draw.
        random : numpy.random.Generator
        """
        rough = self.made.rough
        share = rough[1 + number].behind(self.blur_px) if rough else self.behind.share
        channels = []
        sharp = self._delivered([of.image(share) for of in self.light])
        for light, noise in zip(sharp, self.noise, strict=True):
            least = self.stored.step_variance(light)
            offset = max(noise.offset - float(np.median(least[self.compared])), 0.0)
            more = self.before_coding
            own = PictureNoise(more * offset, more * noise.slope, noise.along, noise.down, noise.blocks)
            channels.append(own.drawn(light, random))
        return self.stored.picture(channels)


def rendered_share(job: TwinJob) -> PaperShare:
    """Render the sharp share of paper in each pixel of a picture.

    Raises
    ------
    DeviceError
        The renderer does not work on this machine.
    """
    take = still_take(job.source.view, job.source.camera, job.camera, job.T_world_target)
    scene = twin_scene(job.camera, job.T_world_target, job.known)
    wanted = EdgeRays(job.spp) if job.rays is None else EdgeRays(job.spp, job.rays, 1 + job.draws)
    made = paper_share(scene, Case(take, job.seed), wanted)
    if job.rays is None:
        return made
    random = generator(job.seed, take.view, take.camera, "lamps")
    return with_lamps(made, job.lamp_variance / job.rays, random)


def rendered_again(job: TwinJob, rendering: PaperShare) -> RenderedAgain:
    """Return the rendering of a picture with the light, blur and noise of its photograph.

    Parameters
    ----------
    job : TwinJob
    rendering : PaperShare
        From :func:`rendered_share`.

    Raises
    ------
    InputError
        The photograph cannot be read, or shows too little that can be compared.
    """
    picture = job.source.read()
    stored = StoredValues.of(picture, job.curve, _coding(job.source))
    photo = stored.channels(picture)
    main = min(1, len(photo) - 1)
    has_mosaic = job.has_mosaic and len(photo) > 1
    target = job.known.target
    radii, places = 0.5 * target.outer_diameters_mm(), job.known.dots
    images = dot_images(job.camera, job.T_world_target, places[job.dots], radii[job.dots])
    dots = job.dots[images.ok]
    random = generator(job.seed, job.source.view, job.source.camera, "twin light")
    blur, fitted_at, compared = FIRST_BLUR_PX, 0.0, np.zeros(photo[main].shape, dtype=bool)
    fitted: tuple[PictureLight, PictureNoise] | None = None
    found: RenderedAgain | None = None
    for _ in range(_ROUNDS):
        behind = BlurredShare.of(rendering.share, blur)
        if not 1.0 / _LIKE < blur / max(fitted_at, 1e-9) < _LIKE:
            margin = 1.0 + _MORE_SIGMAS * blur
            compared = compared_pixels(job.camera, job.T_world_target, target, dots, margin)
            if not compared.any():
                raise _nothing(job)
            fitted = _light_and_noise(photo[main], behind.share, compared, random)
            fitted_at = blur
        if fitted is None:
            raise _nothing(job)
        light, noise = fitted
        around = Windows.around(images.outline[images.ok], blur, compared, not target.is_white_on_black)
        contrast = light.paper.over(behind.share.shape) - light.ink.over(behind.share.shape)
        by_rays = contrast**2 * ray_variance(rendering, blur)
        variance = _least(noise, light.image(behind.share), stored) + by_rays
        seen = green_behind_mosaic(behind) if has_mosaic else behind
        windows = dot_windows(photo[main], variance, seen, light, around)
        step = float(np.clip(windows.typical(BLUR), -0.4 * blur, 1.5))
        found = RenderedAgain(
            stored, photo, [light], [noise], blur, behind, compared, windows, around, rendering
        )
        if abs(step) < _SETTLED_PX:
            break
        blur = float(np.clip(blur + step, _LEAST_BLUR_PX, _MOST_BLUR_PX))
    if found is None:
        raise _nothing(job)
    if len(photo) == 1:
        return found
    others = [_light_and_noise(channel, found.behind.share, found.compared, random) for channel in photo]
    if any(other is None for other in others):
        raise _nothing(job)
    pairs = [other for other in others if other is not None]
    pairs[main] = (found.light[0], found.noise[0])
    return RenderedAgain(
        stored, photo, [one for one, _ in pairs], [one for _, one in pairs], found.blur_px, found.behind,
        found.compared, found.windows, found.around, rendering, has_mosaic=has_mosaic,
    )  # fmt: skip


def _light_and_noise(
    channel: Float32[np.ndarray, "h w"],
    share: Float32[np.ndarray, "h w"],
    compared: Bool[np.ndarray, "h w"],
    random: np.random.Generator,
) -> tuple[PictureLight, PictureNoise] | None:
    light = fitted_light(channel, share, compared, random)
    if light is None:
        return None
    noise = measured_noise(channel, compared & (share > 1.0 - _PURE), compared & (share < _PURE))
    return None if noise is None else (light, noise)


def _least(
    noise: PictureNoise, light: Float32[np.ndarray, "h w"], stored: StoredValues
) -> Float32[np.ndarray, "h w"]:
    """Return the variance of the noise, which is that of rounding at least: dark ink may all be one value."""
    return np.asarray(np.maximum(noise.variance(light), stored.step_variance(light)))


def _coding(source: Source) -> JpegCoding | None:
    """Return how a picture was compressed; None for bytes of a sensor, whatever their name."""
    return None if source.raw is not None else JpegCoding.of(Path(source.image))


def _nothing(job: TwinJob) -> InputError:
    return InputError(
        f"The picture {job.source.image} shows too little of the board that can be compared with a "
        "rendering: dots are too small for their blur, or nearly all are cut. Leave it out with `views`."
    )
