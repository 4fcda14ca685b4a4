"""A rig: cameras by name in one world."""

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_serializer

from labcal.arguments import object_of, one_text, positive_number, wrong_type
from labcal.arrays import AnyArray, float_array
from labcal.cameras.calibration_record import CalibrationRecord
from labcal.cameras.camera import Camera
from labcal.cameras.camera_description import camera_description
from labcal.cameras.camera_pair import CameraPair, camera_pair
from labcal.cameras.expected_errors import ExpectedErrors, expected_errors
from labcal.cameras.record import CameraRecord
from labcal.cameras.rig_covariance import RigCovariance
from labcal.cameras.target_record import TargetRecord
from labcal.errors import InputError, UnknownNameError
from labcal.paths import AnyPath
from labcal.public_object import HtmlTable, PublicObject
from labcal.run.names import Name, is_name
from labcal.wording import clipped, counted, printable

if TYPE_CHECKING:
    import matplotlib.figure
    import pandas
    import xarray


class Rig(PublicObject, BaseModel):
    """Cameras by name. In a rig from a hand-held target the world is the first camera's frame.

    Two rigs are equal where their cameras are, and what is known of their calibration.

    Examples
    --------
    >>> from labcal import examples
    >>> rig = examples.rig()
    >>> rig
    Rig(cameras=['left', 'right'], lens=brown5, baseline=200.0 mm)
    >>> rig.camera("left").size
    (640, 480)
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    format: Literal["labcal-rig"] = "labcal-rig"
    """Kind of the file."""
    format_version: Literal[1] = 1
    """Version of the form of the file."""
    cameras: Annotated[dict[Name, CameraRecord], Field(min_length=1)]
    """Cameras by name."""
    calibrated_on: tuple[str, ...] = ()
    """Names of the views that it was calibrated from, where that is known: figures of these are no check."""
    calibration: CalibrationRecord | None = None
    """Agreement of these cameras; left out of the file if nothing is known."""
    target: TargetRecord | None = None
    """Target that they were calibrated with; left out if not known. It is taken where none is named."""
    covariance: RigCovariance | None = None
    """Joint covariance of lenses and poses; left out if not known: points then have the noise alone."""

    @model_serializer(mode="wrap")
    def _without_what_is_not_known(self, dump: Callable[[BaseModel], dict[str, object]]) -> dict[str, object]:
        return {key: value for key, value in dump(self).items() if value not in (None, (), [])}

    @classmethod
    def of(cls, cameras: Mapping[str, Camera]) -> "Rig":
        """Return the rig of these cameras, in their order.

        Parameters
        ----------
        cameras : mapping of str to Camera
            Names of letters, digits and hyphens, which do not differ in capital letters alone.

        Raises
        ------
        InputError, InputTypeError
            There is no camera, a name is none, or something else than cameras is given.

        Examples
        --------
        >>> import numpy as np
        >>> from labcal import Camera, Rig
        >>> K = [[800, 0, 319.5], [0, 800, 239.5], [0, 0, 1]]
        >>> Rig.of({"only": Camera(K, "pinhole", [0] * 5, np.eye(4), (640, 480))})
        Rig(cameras=['only'], lens=pinhole)
        """
        if not isinstance(cameras, Mapping):
            raise wrong_type(cameras, "a mapping of names to cameras", "cameras")
        if not cameras:
            raise InputError("A rig has one camera or more, but none is given.")
        for name in cameras:
            if not is_name(one_text(name, "cameras")):
                raise InputError(
                    f"'{clipped(printable(name))}' cannot name a camera: a name has letters, digits and "
                    "hyphens."
                )
        given = {name: object_of(camera, Camera, "cameras") for name, camera in cameras.items()}
        return cls(cameras={name: CameraRecord.of(camera) for name, camera in given.items()})

    def camera(self, name: str) -> Camera:
        """Return one camera.

        Raises
        ------
        UnknownNameError
            The rig has no camera of that name; the nearest one is offered.
        """
        if not isinstance(name, str) or name not in self.cameras:
            raise UnknownNameError("camera in the rig", name, self.cameras)
        return self.cameras[name].camera()

    def baseline_mm(self, first: str, second: str) -> float:
        """Return the distance of two cameras' centres of projection, mm.

        Raises
        ------
        UnknownNameError
            The rig has no camera of one of the names.

        Examples
        --------
        >>> from labcal import examples
        >>> round(examples.rig().baseline_mm("left", "right"), 3)
        200.0
        """
        return float(np.linalg.norm(self.camera(second).centre - self.camera(first).centre))

    def pair(self, first: str, second: str) -> CameraPair:
        """Return baseline, mm, and angle, degrees, of two cameras, with their sigmas.

        Raises
        ------
        UnknownNameError
            The rig has no camera of one of the names.

        Examples
        --------
        >>> from labcal import examples
        >>> pair = examples.rig().pair("left", "right")
        >>> round(pair.baseline_mm, 3), round(pair.angle_deg, 3)
        (200.0, 17.189)
        """
        cameras = {name: self.camera(name) for name in (*self.cameras, first, second)}
        return camera_pair(cameras, (first, second), self.covariance)

    def expected_errors(self, places: AnyArray, pixel_sigma_px: float) -> ExpectedErrors:
        """Return the errors to expect of points at such places, in depth and sideways, mm.

        Parameters
        ----------
        places : array_like, shape (n, 3)
            Mm, in the world; those that a camera does not see are left out.
        pixel_sigma_px : float
            Standard deviation of the pixels that points will be measured by, along each axis.

        Raises
        ------
        InputError, InputTypeError
            `places` has another shape or is not made of numbers, or `pixel_sigma_px` is no positive number.

        Examples
        --------
        >>> from labcal import examples
        >>> expected = examples.rig().expected_errors([[0, 0, 600], [60, 20, 650]], 0.02)
        >>> round(expected.depth.noise_mm, 3), round(expected.sideways.noise_mm, 3)
        (0.072, 0.011)
        >>> expected.depth.calibration_mm  # this rig states no covariance
        nan
        """
        places = float_array(places, ("n", 3), "places")
        sigma = positive_number(pixel_sigma_px, "pixel_sigma_px", "px")
        cameras = [self.camera(name) for name in self.cameras]
        known = None if self.covariance is None else self.covariance.matrix
        return expected_errors(cameras, known, places, [sigma] * len(cameras))

    @classmethod
    def load(cls, path: AnyPath) -> "Rig":
        """Read ``rig.json``; as :func:`~labcal.cameras.rig_file.read_rig`, which lists its errors."""
        from labcal.cameras.rig_file import read_rig  # noqa: PLC0415 -- it imports this module

        return read_rig(path)

    def save(self, path: AnyPath, *, force: bool = False) -> None:
        """Write ``rig.json``; as :func:`~labcal.cameras.rig_file.write_rig`, which lists its errors.

        Examples
        --------
        >>> import tempfile
        >>> from labcal import Rig, examples
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     examples.rig().save(f"{folder}/rig.json")
        ...     Rig.load(f"{folder}/rig.json") == examples.rig()
        True
        """
        from labcal.cameras.rig_file import write_rig  # noqa: PLC0415 -- it imports this module

        write_rig(path, self, force=force)

    def to_pandas(self) -> "pandas.DataFrame":
        """Return a table with a line a camera: lens, size, intrinsics and centre of projection.

        Raises
        ------
        DeviceError
            pandas is not installed.

        Examples
        --------
        >>> from labcal import examples
        >>> examples.rig().to_pandas()["fx_px"].tolist()
        [800.0, 805.0]
        """
        from labcal.cameras.rig_tables import rig_frame  # noqa: PLC0415 -- pandas is optional

        return rig_frame(self)

    def to_xarray(self) -> "xarray.Dataset":
        """Return camera matrices, coefficients and poses as arrays with named dimensions.

        Raises
        ------
        DeviceError
            xarray is not installed.

        Examples
        --------
        >>> from labcal import examples
        >>> dict(examples.rig().to_xarray()["T_cam_world"].sizes)
        {'camera': 2, 'row4': 4, 'column4': 4}
        """
        from labcal.cameras.rig_tables import rig_dataset  # noqa: PLC0415 -- xarray is optional

        return rig_dataset(self)

    def plot(self) -> "matplotlib.figure.Figure":
        """Draw the cameras in space: centres of projection, fields of view and baselines, mm.

        Examples
        --------
        >>> from labcal import examples
        >>> len(examples.rig().plot().axes)
        1
        """
        from labcal.cameras.rig_figure import rig_figure  # noqa: PLC0415 -- imports matplotlib

        return rig_figure(self)

    def _summary(self) -> Mapping[str, object]:
        names = list(self.cameras)
        summary: dict[str, object] = {
            "cameras": names,
            "lens": ", ".join(dict.fromkeys(record.lens for record in self.cameras.values())),
        }
        if len(names) == 2:  # noqa: PLR2004 -- a pair
            summary["baseline"] = f"{self.baseline_mm(*names):.1f} mm"
        if self.calibrated_on:
            summary["calibrated_on"] = counted(len(self.calibrated_on), "view")
        if self.calibration is not None and self.calibration.triangulation_rms_px is not None:
            summary["triangulation_rms"] = f"{self.calibration.triangulation_rms_px:.3f} px"
        return summary

    def _html_tables(self) -> Sequence[HtmlTable]:
        rows = []
        for name in self.cameras:
            camera = self.camera(name)
            centre = ", ".join(f"{one:z.1f}" for one in camera.centre.tolist())
            rows.append([name, *map(str, camera_description(camera).values()), centre])
        return [HtmlTable(("camera", "lens", "size", "focal length", "field", "centre (mm)"), rows)]


def contradiction_note(rig: Rig) -> str | None:
    """Return a note if the views that a rig was calibrated from contradict each other; else None."""
    if rig.calibration is None or not rig.calibration.inconsistent:
        return None
    return (
        f"the views that this rig was calibrated from contradict each other (likely "
        f"{rig.calibration.inconsistent[0]}): do not rely on it. Calibrate again."
    )
