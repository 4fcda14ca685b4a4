"""OpenEXR pictures on disk: linear float32 light, with texts in the header."""

import errno
import os
from collections.abc import Mapping
from contextlib import redirect_stdout
from io import StringIO

import numpy as np

from labcal.errors import InputError, OutputError
from labcal.paths import AnyPath, as_path
from labcal.run.outputs import appearing_file
from labcal.shoot.library_messages import kept_messages
from labcal.shoot.picture_header import require_sensible_size


def read_exr(path: AnyPath) -> np.ndarray:
    """Read the colours, or the only channel, of an OpenEXR file.

    Returns
    -------
    ndarray, shape (height, width) or (height, width, 3)
        float32; an alpha channel is dropped.

    Raises
    ------
    InputError
        The file is damaged, or of another kind.
    """
    path = as_path(path)
    import OpenEXR  # noqa: PLC0415 -- a compiled library that few pictures need

    try:
        # What the library has to say about a damaged file is no result, and may be thousands of lines.
        with kept_messages(), redirect_stdout(StringIO()):
            with OpenEXR.File(str(path), header_only=True) as exr:
                first, last = (np.asarray(corner, dtype=np.int64) for corner in exr.header()["dataWindow"])
            width, height = np.maximum(last - first + 1, 0).tolist()
            require_sensible_size(path, (width, height), path.stat().st_size)
            with OpenEXR.File(str(path)) as exr:
                channels = exr.channels()
                colours = (name for name in ("RGB", "RGBA", "Y") if name in channels)
                wanted = next(colours, next(iter(channels)))
                pixels = np.asarray(channels[wanted].pixels, dtype=np.float32)
    except InputError:
        raise
    except Exception as error:
        raise InputError(f"{path} is not an OpenEXR file that can be read: {error}.") from error
    return pixels if pixels.ndim == 2 else np.ascontiguousarray(pixels[..., :3])  # noqa: PLR2004 -- grey


def read_exr_texts(path: AnyPath) -> dict[str, str]:
    """Return the texts in the header of an OpenEXR file, by name.

    Raises
    ------
    InputError
        The file is damaged, or of another kind.
    """
    path = as_path(path)
    import OpenEXR  # noqa: PLC0415 -- as above

    try:
        with kept_messages(), redirect_stdout(StringIO()), OpenEXR.File(str(path), header_only=True) as exr:
            return {name: value for name, value in exr.header().items() if isinstance(value, str)}
    except Exception as error:
        raise InputError(f"{path} is not an OpenEXR file that can be read: {error}.") from error


def write_exr(path: AnyPath, picture: np.ndarray, texts: Mapping[str, str], *, force: bool = False) -> None:
    """Write a float32 picture in channels R, G and B, or Y, compressed without loss.

    Parameters
    ----------
    path : str or os.PathLike
    picture : ndarray of float32, shape (height, width) or (height, width, 3)
    texts : mapping of str to str
        What the header holds besides, by name.

    Raises
    ------
    OutputError
        The file exists and `force` is not set, or it cannot be written.
    """
    path = as_path(path)
    import OpenEXR  # noqa: PLC0415 -- as above

    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage, **texts}
    channels = {"Y" if picture.ndim == 2 else "RGB": np.ascontiguousarray(picture)}  # noqa: PLR2004 -- grey
    with appearing_file(path, force=force) as temporary:
        try:
            OpenEXR.File(header, channels).write(str(temporary))
        except RuntimeError as error:  # it tells what the system said as a text only
            for code in (errno.ENOSPC, errno.EDQUOT):
                if os.strerror(code) in str(error):
                    raise OSError(code, os.strerror(code)) from error
            raise OutputError(f"{path} cannot be written: {error}.") from error
