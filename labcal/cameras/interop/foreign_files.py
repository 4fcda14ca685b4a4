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
    (r"\A#ROSBAG", "a bag of ROS", "Print the cameras: rostopic echo -b FILE -n 1 /camera_info > info.yaml."),
    (r"!!python/", "objects of Python, as yaml.dump writes NumPy's arrays",
     "Write lists of numbers: array.tolist()."),
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
    (r"\"cameraData\"\s*:.*\"intrinsicMatrix\"", "the memory of an OAK camera (DepthAI), lengths in cm",
     "Give intrinsicMatrix, distortionCoeff and the pose of its pair as a file of OpenCV (M1 D1 M2 D2 R T)."),
    (r"\"CalibrationInformation\"", "a calibration of an Azure Kinect, in parts of the picture's size",
     "Export its cameras in pixels as a file of OpenCV (M1 D1 M2 D2 R T)."),
    (r"\"camera_poses\"\s*:", "a calibration of Multical",
     "Give a pair of it as a file of OpenCV (M1 D1 M2 D2 R T)."),
    (r"libCalib", "a calibration of calib.io", "Export it in Calibrator as a file of OpenCV."),
    (r"\A(RadTan|FOV|EquiDistant|KannalaBrandt|Pinhole)?\s*([-+.\de]+ ){4,7}[-+.\de]+\s*\n\d+ \d+\s*\n[cfn]",
     "a camera.txt of DSO, partly in parts of the picture's size",
     "Give its camera as a file of OpenCV (camera_matrix, distortion_coefficients)."),
    (r"\Aextrinsic\s", "a camera of MVSNet, of an undistorted picture",
     "Give the model of COLMAP that it was made of."),
    (r"\A# Bundle file", "a bundle.out of Bundler", "Export it as a model of COLMAP."),
    (r"\ANVM_V3", "a model of VisualSFM", "Export it as a model of COLMAP."),
    (r"ParGroup: Cam|CamType:\s*\"", "camera parameters of HALCON, in metres on the sensor",
     "Give them as a file of OpenCV (camera_matrix, distortion_coefficients)."),
    (r"\APix4D", "a camera of Pix4D, in mm on the sensor", "Export it as a model of COLMAP, or for OpenCV."),
    (r"capturingreality", "a camera of RealityCapture, without pixels", "Export it as a model of COLMAP."),
    (r"^\[CAMERA_PARAMS", "cameras of MRPT", "Give them as a file of OpenCV (M1 D1 M2 D2 R T)."),
    (r"^- camera:.*^\s+T_B_C:", "cameras of SVO or maplab",
     "Give them as Kalibr's camchain.yaml, which they are mostly made of."),
    (r"^P[01]: ", "a calib.txt of KITTI, of rectified pictures",
     "Give it as a file of OpenCV (M1 D1 M2 D2 R T) with zero distortion."),
    (r"^kind:\s*(charuco|chessboard|april|dots|grid)", "the description of a target",
     "Give the file of cameras."),
    (r"^(pitch_x_mm|square_mm|marker_mm):", "the description of a target", "Give the file of cameras."),
    (r"\"?CameraIntrinsics\"?:.*\"?CX\"?:", "intrinsics of a Zivid camera",
     "Give them as a file of OpenCV (camera_matrix, distortion_coefficients)."),
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
