"""A note on principal points that lie where no lens has its axis."""

from labcal.cameras.camera import Camera


def principal_point_note(name: str, camera: Camera) -> str | None:
    """Return a note where the principal point is outside of the picture; None where it is in it.

    Parameters
    ----------
    name : str
        The camera's.
    camera : Camera
    """
    _, _, cx, cy = camera.intrinsics
    width, height = camera.size
    if 0.0 <= cx <= width - 1 and 0.0 <= cy <= height - 1:
        return None
    return (
        f"the principal point of {name}, ({cx:.1f}, {cy:.1f}) px, lies outside of its picture of {width} x "
        f"{height} px: the size, or the order of the numbers, may be another one, or the pictures are parts "
        "of larger ones"
    )
