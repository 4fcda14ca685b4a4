"""Files of programs whose cameras are not read: by what they hold, the program and another way."""

import re

_ANEW = "Calibrate the same cameras with labcal."
_SAVEZ = "numpy.savez('camera.npz', camera_matrix=K, dist_coeffs=D)"
_KNOWN: tuple[tuple[str, str, str], ...] = (
    (r"\A\s*\Z", "empty", "Copy it again."),
    (r"\A(\x89PNG|\xff\xd8\xff|II\*\0|MM\0\*|BM.{4}\0{4})", "a picture", "Give the file of cameras."),
    (r"\A\x93NUMPY", "one array of NumPy (.npy)",
     f"Save matrices together: {_SAVEZ}."),
    (r"\A(\x80[\x02-\x05]|\(dp0)", "a pickle of Python, which is a program and is not run",
     f"Save matrices in Python: {_SAVEZ}."),
    (r"\A\x89HDF", "HDF5", "Of MATLAB, save it with '-v7'."),
    (r"\ASQLite format", "a database, as COLMAP keeps its features in",
     "Give the folder of its model (sparse/0)."),
    (r"\Aply\s", "points (PLY)", "Give the file of cameras."),
    (r"^\d+ ([-+.\deE]+ ){7}\d+ \S+$", "images.txt of a model of COLMAP", "Give the folder that it is in."),
    (r"^target_type:", "a target of Kalibr", "Give camchain.yaml."),
    (r"^imu0:", "Kalibr's file of an IMU", "Give camchain.yaml."),
    (r"^Camera-system parameters:", "Kalibr's results in words", "Give camchain.yaml, which is beside it."),
    (r"\"format\":\s*\"labcal-shoot\"", "a shoot of labcal", "Calibrate it, and give its rig.json."),
    (r"^(fc|cc|kc)(_left)? *= *\[", "a script of Bouguet's calibration toolbox (Calib_Results.m)",
     "Convert Calib_Results.mat, which the toolbox saves beside it."),
    (r"^[ \t]*Model[ \t]*=[ \t]*CAHV", "a .cahvor model", "Convert it first: mrcal-from-cahvor FILE."),
    (r"^\[(LEFT|RIGHT)_CAM_(2K|FHD|HD|VGA)", "settings of a ZED camera, with numbers for each resolution",
     "Give those of your pictures' resolution as a file of OpenCV (M1 D1 M2 D2 R T)."),
    (r"^K_0\d:.*^D_0\d:", "KITTI's calib_cam_to_cam.txt",
     "Give K_xx, D_xx, R_xx and T_xx of a pair as a file of OpenCV (M1 D1 M2 D2 R T)."),
    (r"^cam0=\[.*^cam1=\[", "a calib.txt of Middlebury, of rectified pictures",
     "Give it as a file of OpenCV (M1 D1 M2 D2 R T) with zero distortion."),
    (r"<CoordinateMapper|<PinholeParameters|CalibrationType=\"Pinhole",
     "a calibration of LaVision DaVis, whose formulas are not published",
     _ANEW),
    (r"<document[^>]*>\s*<chunk|<chunk [^>]*label=", "a project of Metashape",
     "Save each camera instead: Tools, Camera Calibration, Save, as Agisoft *.xml."),
    (r"<miqus|<fov_video|focalLengthU=", "a calibration of Qualisys, whose lens is none of OpenCV's", _ANEW),
    (r"VICON_RADIAL|<Cameras FORMAT_VERSION", "a calibration of Vicon, whose lens is none of OpenCV's",
     _ANEW),
    (r"\"intrinsicId\"", "a scene of AliceVision (Meshroom)", "Export it as a model of COLMAP."),
    (r"\"CameraIntrinsicsPrior\"|\"camera_intrinsics_type\"", "a calibration of TheiaSfM",
     "Export it as a model of COLMAP."),
    (r"\"projection_type\"", "cameras of OpenSfM", "Export it as a model of COLMAP (export_colmap)."),
    (r"\"ppx\"\s*:", "intrinsics of a RealSense camera",
     "Give them as a file of OpenCV with camera_matrix, distortion_coefficients and the size."),
    (r"\"intrinsic_matrix\"\s*:", "intrinsics of Open3D, column by column and without a lens",
     "Give them as a file of OpenCV with camera_matrix, distortion_coefficients and the size."),
    (r"\"transform_matrix\"", "a transforms.json whose frames have no common lens in pixels (fl_x)",
     "Give the file of the program that calibrated the camera, such as COLMAP's model."),
    (r"^kind:\s*(charuco|chessboard|april|dots|grid)", "the description of a target",
     "Give the file of cameras."),
    (r"^(pitch_x_mm|square_mm|marker_mm):", "the description of a target", "Give the file of cameras."),
    (r"\A[-+.\deE\s,;]+\Z", "numbers without names",
     f"Give them names, as OpenCV's FileStorage does, or {_SAVEZ}."),
)  # fmt: skip
"""Patterns of the content, what it is, and advice."""
_SEEN = 20_000
"""Characters that are looked at."""
_FLAGS = re.MULTILINE | re.DOTALL


def foreign_words(text: str) -> str | None:
    """Return what a file of no format that is read seems to be, and what to do; None if it is unknown.

    Parameters
    ----------
    text : str
        The beginning of its content; of bytes that are no text, a character each.
    """
    beginning = text[:_SEEN]
    for pattern, what, mend in _KNOWN:
        if re.search(pattern, beginning, _FLAGS):
            return f"It seems to be {what}. {mend}"
    return None
