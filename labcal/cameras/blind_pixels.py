"""Notes on pixels that see no direction."""

from labcal.cameras.camera import Camera


def blind_pixels(name: str, camera: Camera) -> str | None:
    """Return a note where some pixels of a camera see no direction; None where all do.

    Parameters
    ----------
    name : str
        The camera's.
    camera : Camera
    """
    share = camera.share_without_rays
    if share == 0.0:
        return None
    return (
        f"{100.0 * share:.1f}% of the picture of {name} sees no direction: the lens '{camera.lens}' folds "
        "there, or the picture reaches beyond its field. Points there are lost; if the picture is not black "
        "there, take pictures with dots up to its corners, or another lens model"
    )
