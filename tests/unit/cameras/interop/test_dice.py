"""DICe's camera system files, as its own tests have them, and projects of VIC-3D."""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from labcal.cameras.interop.dice import read_dice, write_dice
from labcal.cameras.interop.exchange import ReadOptions, ReadRig, SourceText
from labcal.cameras.interop.registry import recognised_format
from labcal.cameras.rig import Rig
from labcal.errors import InputError

MakeRig = Callable[..., Rig]
SYSTEM = """<ParameterList>
<!-- DICe formatted camera system file -->
<Parameter name="xml_file_format" type="string" value="DICe_xml_camera_system_file" />
<Parameter name="system_type_3D" type="string" value="OPENCV" />
<Parameter name="extrinsics_relative_camera_to_camera" type="bool" value="true" />
<ParameterList name="CAMERA 0">
<Parameter name="CAMERA_ID" type="string" value="left eye" />
<Parameter name="CX" type="double" value="6.5e+02" />
<Parameter name="CY" type="double" value="407.5" />
<Parameter name="FX" type="double" value="2468.5" />
<Parameter name="FY" type="double" value="2468.25" />
<Parameter name="K1" type="double" value="-0.125" />
<Parameter name="LENS_DISTORTION_MODEL" type="string" value="OPENCV_LENS_DISTORTION" />
<Parameter name="TZ" type="double" value="10" />
<Parameter name="IMAGE_HEIGHT_WIDTH" type="string" value="{ 800, 1280 }" />
</ParameterList>
<ParameterList name="CAMERA 1">
<Parameter name="CX" type="double" value="628" />
<Parameter name="CY" type="double" value="394" />
<Parameter name="FX" type="double" value="2377" />
<Parameter name="FY" type="double" value="2376" />
<Parameter name="TX" type="double" value="130.75" />
<Parameter name="ALPHA" type="double" value="0.5" />
<Parameter name="BETA" type="double" value="-18.0" />
<Parameter name="GAMMA" type="double" value="2.0" />
<Parameter name="IMAGE_HEIGHT_WIDTH" type="string" value="{ 800, 1280 }" />
</ParameterList>
</ParameterList>
"""
PROJECT = """<?xml version="1.0" encoding="ISO-8859-1"?>
<!DOCTYPE vpml>
<project dir="C:/CalA">
 <calibration lri="calibration">
  <camera id="0">638 407 2468.5 2468.25 0 0 0 0<orientation>180 9 0 -63 -0.5 18</orientation></camera>
  <camera id="1">628 394 2377 2376 0 0 0 0<orientation>-180 -9 0 64 -0.5 15</orientation></camera>
 </calibration>
 <projectaois><aoinode><polygonmask width="1280" height="800"></polygonmask></aoinode></projectaois>
</project>
"""


def read(text: str) -> ReadRig:
    assert recognised_format(SourceText(Path("cal.xml"), text)) is not None
    return read_dice([SourceText(Path("cal.xml"), text)])


def test_a_system_whose_second_camera_is_placed_by_the_first() -> None:
    cameras = read(SYSTEM).rig.cameras
    assert list(cameras) == ["left-eye", "CAMERA-1"]
    left, right = cameras.values()
    assert (left.lens, left.dist[0], left.size) == ("brown-k1k2", -0.125, (1280, 800))
    assert right.lens == "pinhole"
    assert left.K == ((2468.5, 0.0, 650.0), (0.0, 2468.25, 407.5), (0.0, 0.0, 1.0))
    # R = Rz(gamma) Ry(beta) Rx(alpha), from the elements that DICe's source writes out.
    a, b, c = np.radians([0.5, -18.0, 2.0])
    T = np.array(right.T_cam_world)
    assert T[2, 0] == pytest.approx(-np.sin(b))
    assert T[2, 1] == pytest.approx(np.sin(a) * np.cos(b))
    assert T[1, 0] == pytest.approx(np.cos(b) * np.sin(c))
    np.testing.assert_allclose(T[:3, 3], [130.75, 0.0, 0.0] + T[:3, :3] @ [0.0, 0.0, 10.0])


def test_what_is_written_names_every_coefficient(make_rig: MakeRig) -> None:
    text = write_dice(make_rig("tilted14"), ".xml").files[0].text
    dist = make_rig("tilted14").cameras["left"].dist
    for name, value in zip(
        ["K1", "K2", "P1", "P2", "K3", "K4", "K5", "K6", "S1", "S2", "S3", "S4", "T1", "T2"],
        dist,
        strict=True,
    ):
        assert f'name="{name}" type="double" value="{value!r}"' in text


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('value="OPENCV_LENS_DISTORTION"', 'value="K1R1_K2R2_K3R3"', "lens model K1R1_K2R2_K3R3"),
        ('"K1" type="double"', '"FS" type="double"', "skew FS = -0.125"),
        ("{ 800, 1280 }", "{ 0, 0 }", "no size of a picture"),
        ("{ 800, 1280 }", "{ 800 }", "IMAGE_HEIGHT_WIDTH should hold 2 numbers"),
        ('value="2468.5"', 'value="nan"', "FX should be a finite number"),
        ("CAMERA 0", "CAMERA 5", "no 'CAMERA 0'"),
        ("</ParameterList>\n</ParameterList>", "</ParameterList>", "is not XML"),
    ],
)
def test_systems_that_cannot_be_read(old: str, new: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        read(SYSTEM.replace(old, new))


def test_a_project_of_vic3d_without_distortion() -> None:
    cameras = read(PROJECT).rig.cameras
    assert list(cameras) == ["camera-0", "camera-1"]
    first = cameras["camera-0"]
    assert (first.lens, first.size) == ("pinhole", (1280, 800))
    turn = Rotation.from_euler("y", 9.0, degrees=True) * Rotation.from_euler("x", 180.0, degrees=True)
    np.testing.assert_allclose(np.array(first.T_cam_world)[:3, :3], turn.as_matrix(), atol=1e-12)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("2468.25 0 0 0 0", "2468.25 -0.17 0.06 0 0", "does not publish"),
        ("polygonmask", "mask", "no area of interest"),
        ("camera", "kamera", "without a calibration"),
        ("180 9 0 -63 -0.5 18", "180 9 0", "orientation of camera-0 should hold 6"),
    ],
)
def test_projects_that_cannot_be_read(old: str, new: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        read_dice([SourceText(Path("cal.xml"), PROJECT.replace(old, new))])


def test_the_size_of_a_project_without_an_area_of_interest_can_be_given() -> None:
    text = re.sub(" <projectaois>.*</projectaois>\n", "", PROJECT)
    source = SourceText(Path("cal.xml"), text)
    with pytest.raises(InputError, match="`size='1280x960'`"):
        read_dice([source])
    (record, _) = read_dice([source], ReadOptions(size=(1280, 800))).rig.cameras.values()
    assert record.size == (1280, 800)
    with pytest.raises(InputError, match=r"states a picture size of 1280x800\. Leave `size` out"):
        read_dice([SourceText(Path("cal.xml"), PROJECT)], ReadOptions(size=(640, 480)))
    with pytest.raises(InputError, match=r"states a picture size of 1280x800\. Leave `size` out"):
        read_dice([SourceText(Path("cal.xml"), SYSTEM)], ReadOptions(size=(640, 480)))


@pytest.mark.parametrize("name", ["CAMERA 2", "CAMERA1", "camera 1", ""])
def test_no_camera_is_left_out(name: str) -> None:
    text = SYSTEM.replace('name="CAMERA 1"', f'name="{name}"' if name else 'ame="CAMERA 1"')
    with pytest.raises(InputError, match=rf"has a list '{name}' behind 1 cameras"):
        read_dice([SourceText(Path("a.xml"), text)])
    users = '<ParameterList name="user_4x4_params"></ParameterList>\n'
    text = SYSTEM.replace('<ParameterList name="CAMERA 0">', users + '<ParameterList name="CAMERA 0">')
    assert len(read_dice([SourceText(Path("a.xml"), text)]).rig.cameras) == 2


def test_coefficients_without_a_lens_model_are_not_left_out() -> None:
    line = '<Parameter name="LENS_DISTORTION_MODEL" type="string" value="OPENCV_LENS_DISTORTION" />\n'
    with pytest.raises(InputError, match="CAMERA 0 has coefficients of a lens, but no LENS_DISTORTION_MODEL"):
        read_dice([SourceText(Path("a.xml"), SYSTEM.replace(line, "", 1))])
