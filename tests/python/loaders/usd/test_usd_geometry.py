# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""USD geometry: meshes and their primvars, primitives, instances, cameras, units, what is hidden, what is damaged."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from pxr import Gf, Sdf, Usd, UsdGeom

import eclat
from eclat.errors import EclatError, EclatWarning
from eclat.scene import Mesh
from support.usd_files import SQUARE, load_usda, save_usda

MOVED = 'uniform token[] xformOpOrder = ["xformOp:translate"]'


def only(folder: Path, body: str, head: str = 'upAxis = "Y"\n    metersPerUnit = 1') -> Mesh:
    meshes = load_usda(folder, body, head).meshes
    assert len(meshes) == 1
    return meshes[0]


def volume(mesh: Mesh) -> float:
    """By the divergence theorem; positive if triangles are counter-clockwise from outside."""
    a, b, c = np.moveaxis(np.asarray(mesh.positions, np.float64)[mesh.triangles], 1, 0)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def faces_of(mesh: Mesh) -> NDArray[np.float64]:
    a, b, c = np.moveaxis(np.asarray(mesh.positions, np.float64)[mesh.triangles], 1, 0)
    return np.asarray(np.cross(b - a, c - a))


def test_a_polygon_mesh_without_normals_is_flat(tmp_path: Path) -> None:
    mesh = only(tmp_path, f'def Mesh "m" {{ {SQUARE} }}')
    assert mesh.normals is None and mesh.triangles.shape == (2, 3) and mesh.name == "m"
    assert (faces_of(mesh)[:, 2] > 0).all()
    assert mesh.material.vertex_colors and mesh.colors is not None
    np.testing.assert_allclose(mesh.colors[0], [0.5, 0.5, 0.5, 1])


def test_units_and_the_axis_that_is_up(tmp_path: Path) -> None:
    body = f'def Xform "g" {{ double3 xformOp:translate = (100, 0, 0)\n{MOVED}\ndef Mesh "m" {{ {SQUARE} }} }}'
    scene = load_usda(tmp_path, body, 'upAxis = "Z"\n    metersPerUnit = 0.01')
    np.testing.assert_allclose(scene.meshes[0].positions.min(axis=0), [0.99, -0.01, 0], atol=1e-6)
    assert scene.up == (0, 0, 1)
    assert load_usda(tmp_path, body).up == (0, 1, 0)
    # Without a unit, lengths are in centimetres, and y is up.
    plain = load_usda(tmp_path, body, '"a comment"')
    np.testing.assert_allclose(plain.meshes[0].positions.max(axis=0), [1.01, 0.01, 0], atol=1e-6)


def test_left_handed_faces_are_turned(tmp_path: Path) -> None:
    left = 'uniform token orientation = "leftHanded"'
    assert (faces_of(only(tmp_path, f'def Mesh "m" {{ {SQUARE} {left} }}'))[:, 2] < 0).all()
    smooth = SQUARE.replace('"none"', '"catmullClark"')
    with pytest.warns(EclatWarning, match="subdivision surfaces are not refined"):
        mesh = only(tmp_path, f'def Mesh "m" {{ {smooth} {left} }}')
    assert mesh.normals is not None
    np.testing.assert_allclose(mesh.normals, [[0, 0, -1]] * 4, atol=1e-6)


def test_a_mirrored_mesh_keeps_its_outside(tmp_path: Path) -> None:
    mirror = 'double3 xformOp:scale = (-2, 1, 1)\nuniform token[] xformOpOrder = ["xformOp:scale"]'
    mesh = only(tmp_path, f'def Cube "c" {{ {mirror} }}')
    assert volume(mesh) == pytest.approx(16)
    assert mesh.normals is not None
    a = np.asarray(mesh.normals)[mesh.triangles[:, 0]]
    assert (np.einsum("ij,ij->i", faces_of(mesh), a) > 0).all()


PRIMVARS = {
    "constant": ("[(0.1, 0.2, 0.3)]", lambda corner: (0.1, 0.2, 0.3)),
    "uniform": ("[(0, 0, 0), (1, 0, 0)]", lambda corner: (0, 0, 0) if corner < 3 else (1, 0, 0)),
    "vertex": (
        "[(0, 0, 0), (0.1, 0, 0), (0.2, 0, 0), (0.3, 0, 0)]",
        lambda corner: ((0, 0.1, 0.2, 0, 0.2, 0.3)[corner], 0, 0),
    ),
    "faceVarying": (
        "[(0, 0, 0), (0.1, 0, 0), (0.2, 0, 0), (0.3, 0, 0), (0.4, 0, 0), (0.5, 0, 0)]",
        lambda corner: (corner / 10, 0, 0),
    ),
}


@pytest.mark.parametrize("interpolation", PRIMVARS)
def test_primvars_of_every_interpolation(tmp_path: Path, interpolation: str) -> None:
    """Two triangles of four points; the colour of each corner is asserted, found by its position and its triangle."""
    values, expected = PRIMVARS[interpolation]
    mesh = only(
        tmp_path,
        f"""def Mesh "m" {{
            int[] faceVertexCounts = [3, 3]
            int[] faceVertexIndices = [0, 1, 2, 0, 2, 3]
            point3f[] points = [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]
            uniform token subdivisionScheme = "none"
            color3f[] primvars:displayColor = {values} (interpolation = "{interpolation}")
        }}""",
    )
    assert mesh.colors is not None
    got = mesh.colors[mesh.triangles.ravel(), :3]
    np.testing.assert_allclose(got, [expected(corner) for corner in range(6)], atol=1e-6)
    np.testing.assert_allclose(
        mesh.positions[mesh.triangles.ravel()][:, :2], [(-1, -1), (1, -1), (1, 1), (-1, -1), (1, 1), (-1, 1)]
    )


def test_indexed_primvars_and_normals_of_faces(tmp_path: Path) -> None:
    mesh = only(
        tmp_path,
        f"""def Mesh "m" {{ {SQUARE}
            color3f[] primvars:displayColor = [(1, 0, 0), (0, 1, 0)] (interpolation = "vertex")
            int[] primvars:displayColor:indices = [1, 0, 1, 1]
            float[] primvars:displayOpacity = [0.25] (interpolation = "constant")
            normal3f[] normals = [(0, 3, 4)] (interpolation = "uniform")
        }}""",
    )
    assert mesh.colors is not None and mesh.normals is not None
    by_place = {tuple(place): color for place, color in zip(mesh.positions[:, :2].tolist(), mesh.colors, strict=True)}
    np.testing.assert_allclose(by_place[(1, -1)], [1, 0, 0, 0.25])
    np.testing.assert_allclose(by_place[(1, 1)], [0, 1, 0, 0.25])
    np.testing.assert_allclose(mesh.normals, [[0, 0.6, 0.8]] * 4, atol=1e-6)


def test_a_primvar_of_the_wrong_length_is_ignored_with_a_warning(tmp_path: Path) -> None:
    wrong = 'color3f[] primvars:displayColor = [(1, 0, 0), (0, 1, 0)] (interpolation = "vertex")'
    with pytest.warns(EclatWarning, match="expected at least 4 vertex values of displayColor, got 2; it is ignored"):
        only(tmp_path, f'def Mesh "m" {{ {SQUARE} {wrong} }}')


def test_subsets_have_their_own_materials_and_the_rest_has_the_mesh_s(tmp_path: Path) -> None:
    def material(name: str, color: str) -> str:
        inputs = f'uniform token info:id = "UsdPreviewSurface"\ncolor3f inputs:diffuseColor = {color}'
        shader = f'def Shader "s" {{ {inputs}\ntoken outputs:surface }}'
        return f'def Material "{name}" {{ token outputs:surface.connect = </{name}/s.outputs:surface>\n{shader} }}'

    scene = load_usda(
        tmp_path,
        material("red", "(1, 0, 0)")
        + material("blue", "(0, 0, 1)")
        + """
        def Mesh "m" (prepend apiSchemas = ["MaterialBindingAPI"]) {
            int[] faceVertexCounts = [3, 3]
            int[] faceVertexIndices = [0, 1, 2, 0, 2, 3]
            point3f[] points = [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]
            uniform token subdivisionScheme = "none"
            rel material:binding = </red>
            uniform token subsetFamily:materialBind:familyType = "nonOverlapping"
            def GeomSubset "upper" (prepend apiSchemas = ["MaterialBindingAPI"]) {
                uniform token elementType = "face"
                uniform token familyName = "materialBind"
                int[] indices = [1]
                rel material:binding = </blue>
            }
        }""",
    )
    found = {mesh.material.name: mesh for mesh in scene.meshes}
    assert set(found) == {"red", "blue"}
    assert found["blue"].material.parameters["base_color"].constant == (0, 0, 1)
    assert found["blue"].positions[:, 0].mean() < 0 < found["red"].positions[:, 0].mean()
    assert [len(mesh.triangles) for mesh in scene.meshes] == [1, 1]


def test_sides(tmp_path: Path) -> None:
    for text, both in (("", True), ("uniform bool doubleSided = 1", True), ("uniform bool doubleSided = 0", False)):
        material = only(tmp_path, f'def Mesh "m" {{ {SQUARE} {text} }}').material
        assert material.two_sided == both and material.back_culled != both


def test_what_is_hidden_is_left_out(tmp_path: Path) -> None:
    def ball(name: str, text: str = "", inside: str = "") -> str:
        return f'def Xform "{name}" {{ {text}\n def Sphere "{name}_ball" {{ {inside} }} }}'

    body = (
        ball("shown")
        + ball("render", 'uniform token purpose = "render"')
        + ball("gone", 'token visibility = "invisible"')
        + ball("proxy", 'uniform token purpose = "proxy"')
        + ball("guide", "", 'uniform token purpose = "guide"')
    )
    assert [mesh.name for mesh in load_usda(tmp_path, body).meshes] == ["shown_ball", "render_ball"]


def test_values_over_time_are_those_of_the_first_time(tmp_path: Path) -> None:
    moving = "double3 xformOp:translate.timeSamples = { 5: (1, 0, 0), 9: (7, 0, 0) }\n" + MOVED
    with pytest.warns(EclatWarning, match="values that change over time are those of the first time") as found:
        mesh = only(tmp_path, f'def Cube "c" {{ {moving} }}')
    assert mesh.positions[:, 0].mean() == pytest.approx(1)
    assert len(found) == 1
    with pytest.warns(EclatWarning, match="the first time"):
        mesh = only(
            tmp_path, f'def Cube "c" {{ {moving} }}', "startTimeCode = 7\n    endTimeCode = 9\n metersPerUnit = 1"
        )
    assert mesh.positions[:, 0].mean() == pytest.approx(4)


GPRIMS: dict[str, tuple[str, float, float]] = {
    # The attributes, the volume, and how far below it a tessellation of 64 segments may be.
    "Cube": ("double size = 3", 27.0, 0),
    "Sphere": ("double radius = 0.5", 4 / 3 * math.pi * 0.125, 0.003),
    "Cylinder": ('double radius = 2\ndouble height = 3\nuniform token axis = "AXIS"', 12 * math.pi, 0.002),
    "Cone": ('double radius = 2\ndouble height = 3\nuniform token axis = "AXIS"', 4 * math.pi, 0.002),
    "Capsule": (
        'double radius = 1\ndouble height = 2\nuniform token axis = "AXIS"',
        2 * math.pi + 4 / 3 * math.pi,
        0.004,
    ),
    "Cylinder_1": (
        'double radiusBottom = 2\ndouble radiusTop = 1\ndouble height = 3\nuniform token axis = "AXIS"',
        math.pi * (4 + 2 + 1),
        0.002,
    ),
    "Capsule_1": (
        'double radiusBottom = 1\ndouble radiusTop = 1\ndouble height = 2\nuniform token axis = "AXIS"',
        2 * math.pi + 4 / 3 * math.pi,
        0.004,
    ),
}


@pytest.mark.parametrize("axis", "XYZ")
@pytest.mark.parametrize("kind", GPRIMS)
def test_primitives_have_the_volume_and_the_extent_of_the_schema(tmp_path: Path, kind: str, axis: str) -> None:
    text, expected, error = GPRIMS[kind]
    path = save_usda(tmp_path, f'def {kind} "p" {{ {text.replace("AXIS", axis)} }}')
    mesh = eclat.load(path).meshes[0]
    assert volume(mesh) == pytest.approx(expected, rel=max(error, 1e-6))
    stage = Usd.Stage.Open(str(path))
    box = UsdGeom.Boundable.ComputeExtentFromPlugins(
        UsdGeom.Boundable(stage.GetPrimAtPath("/p")), Usd.TimeCode.Default()
    )
    got = np.array([mesh.positions.min(axis=0), mesh.positions.max(axis=0)])
    if kind == "Capsule_1":  # whose extent is that of a box around larger spheres in the package
        assert (np.abs(got) <= np.abs(np.array(box)) + 1e-5).all()
    else:
        np.testing.assert_allclose(got, np.array(box), atol=2e-3 * np.abs(box).max())
    assert mesh.normals is not None
    normals = np.asarray(mesh.normals)[mesh.triangles].mean(axis=1)
    assert (np.einsum("ij,ij->i", faces_of(mesh), normals) > 0).all()
    assert np.linalg.norm(mesh.normals, axis=1) == pytest.approx(1, abs=1e-5)


def test_a_tapered_capsule_is_smooth_and_touches_its_spheres(tmp_path: Path) -> None:
    mesh = only(
        tmp_path,
        'def Capsule_1 "p" { double radiusBottom = 1\ndouble radiusTop = 0.4\ndouble height = 2\nuniform token axis = "Z" }',
    )
    low, high = (np.linalg.norm(np.asarray(mesh.positions) - [0, 0, z], axis=1) for z in (-1, 1))
    assert low.min() == pytest.approx(1, abs=1e-4) and high.min() == pytest.approx(0.4, abs=1e-4)
    assert mesh.positions[:, 2].min() == pytest.approx(-2) and mesh.positions[:, 2].max() == pytest.approx(1.4)


@pytest.mark.parametrize(("axis", "extent"), [("X", (0, 6, 4)), ("Y", (4, 0, 6)), ("Z", (4, 6, 0))])
def test_a_plane_faces_its_axis(tmp_path: Path, axis: str, extent: tuple[float, float, float]) -> None:
    mesh = only(tmp_path, f'def Plane "p" {{ double width = 4\ndouble length = 6\nuniform token axis = "{axis}" }}')
    np.testing.assert_allclose(np.ptp(mesh.positions, axis=0), extent, atol=1e-6)
    assert (faces_of(mesh)[:, "XYZ".index(axis)] > 0).all()


def test_native_instances_share_their_prototype(tmp_path: Path) -> None:
    def instance(name: str, x: float) -> str:
        head = f'def Xform "{name}" (instanceable = true\nprepend references = </_proto>)'
        return f"{head} {{ double3 xformOp:translate = ({x}, 0, 0)\n{MOVED} }}\n"

    body = 'class Xform "_proto" { def Xform "inner" { def Cube "cube" { double size = 1 } } }\n'
    scene = load_usda(tmp_path, body + instance("a", 2) + instance("b", 5))
    assert sorted(float(mesh.positions[:, 0].mean()) for mesh in scene.meshes) == pytest.approx([2, 5])
    # They share what does not depend on where they are.
    assert scene.meshes[0].triangles is scene.meshes[1].triangles


def test_point_instancers_place_their_prototypes(tmp_path: Path) -> None:
    """Each copy lies where its position, its rotation, its scale and the prototype's own transform put it."""
    body = """
    def PointInstancer "many" {
        double3 xformOp:translate = (0, 10, 0)
        uniform token[] xformOpOrder = ["xformOp:translate"]
        rel prototypes = [</many/box>, </many/ball>]
        int[] protoIndices = [0, 1, 0, 1]
        int64[] ids = [10, 11, 12, 13]
        int64[] invisibleIds = [13]
        point3f[] positions = [(0, 0, 0), (4, 0, 0), (8, 0, 0), (12, 0, 0)]
        quath[] orientations = [(1, 0, 0, 0), (1, 0, 0, 0), (0.70710677, 0, 0, 0.70710677), (1, 0, 0, 0)]
        float3[] scales = [(1, 1, 1), (2, 2, 2), (1, 1, 1), (1, 1, 1)]
        def Cube "box" {
            double size = 1
            double3 xformOp:translate = (3, 0, 0)
            uniform token[] xformOpOrder = ["xformOp:translate"]
        }
        def Sphere "ball" { double radius = 1 }
    }"""
    scene = load_usda(tmp_path, body)
    middles = [((m.positions.min(axis=0) + m.positions.max(axis=0)) / 2).tolist() for m in scene.meshes]
    # A quarter turn about z puts the third copy's offset of 3 along x to y.
    np.testing.assert_allclose(middles, [[3, 10, 0], [4, 10, 0], [8, 13, 0]], atol=1e-3)
    assert np.ptp(scene.meshes[1].positions[:, 0]) == pytest.approx(4, rel=2e-3)


def test_instances_of_instances_of_nothing_end(tmp_path: Path) -> None:
    """Ten levels of ten references each would be ten thousand million prims."""
    levels = ['class "l0" { def Sphere "s" (active = true) {} }']
    for level in range(1, 10):
        copies = "\n".join(
            f'def "c{n}" (instanceable = true\nprepend references = </l{level - 1}>) {{}}' for n in range(10)
        )
        levels.append(f'class "l{level}" {{ {copies} }}')
    body = "\n".join(levels) + '\ndef "top" (instanceable = true\nprepend references = </l9>) {}'
    with pytest.raises(EclatError, match="expected at most 512 MiB of geometry"):
        load_usda(tmp_path, body)


CAMERAS: list[dict[str, Any]] = [
    {"horizontalAperture": 36, "verticalAperture": 24, "focalLength": 50},
    {"horizontalAperture": 20, "verticalAperture": 30, "focalLength": 18, "horizontalApertureOffset": 3},
    {"horizontalAperture": 36, "verticalAperture": 24, "focalLength": 35, "verticalApertureOffset": -5},
    {"horizontalAperture": 40, "verticalAperture": 20, "projection": '"orthographic"'},
]


@pytest.mark.parametrize("lens", CAMERAS)
def test_cameras_see_what_those_of_usd_see(tmp_path: Path, lens: dict[str, Any]) -> None:
    """The corners of the picture are those of the frustum that the package computes."""
    types = {"projection": "token"}
    text = "\n".join(f"{types.get(name, 'float')} {name} = {value}" for name, value in lens.items())
    place = "matrix4d xformOp:transform = ((0, 0, -1, 0), (0, 1, 0, 0), (1, 0, 0, 0), (5, 6, 7, 1))\n"
    place += 'uniform token[] xformOpOrder = ["xformOp:transform"]'
    path = save_usda(tmp_path, f'def Camera "eye" {{ {text}\n{place} }}\ndef Sphere "s" {{}}')
    camera = eclat.load(path).cameras[0]
    stage = Usd.Stage.Open(str(path))
    frustum = UsdGeom.Camera(stage.GetPrimAtPath("/eye")).GetCamera(1).frustum
    window = frustum.GetWindow()
    assert camera.size is not None
    aspect = window.GetSize()[0] / window.GetSize()[1]
    half_width, half_height = camera.half_extent(aspect)
    left = (2 * camera.shift[0] - 1) * half_width
    top = (1 - 2 * camera.shift[1]) * half_height
    assert (left, top) == pytest.approx((window.GetMin()[0], window.GetMax()[1]), rel=1e-5)
    assert left + 2 * half_width == pytest.approx(window.GetMax()[0], rel=1e-5)
    assert camera.size[0] / camera.size[1] == pytest.approx(aspect, rel=2e-3)
    np.testing.assert_allclose(camera.to_world[:3, 3], frustum.GetPosition())
    np.testing.assert_allclose(-camera.to_world[:3, 2], frustum.ComputeViewDirection(), atol=1e-6)
    np.testing.assert_allclose(camera.to_world[:3, 1], frustum.ComputeUpVector(), atol=1e-6)
    assert isinstance(frustum, Gf.Frustum)


def test_a_lens_blurs_in_metres(tmp_path: Path) -> None:
    """50 mm at f/2 have an aperture of 25 mm, if a tenth of the unit is a millimetre."""
    lens = "float focalLength = 50\nfloat fStop = 2\nfloat focusDistance = 300"
    scene = load_usda(
        tmp_path, f'def Camera "eye" {{ {lens} }}\ndef Sphere "s" {{}}', 'upAxis = "Y"\n    metersPerUnit = 0.01'
    )
    assert scene.cameras[0].aperture_radius == pytest.approx(0.0125)
    assert scene.cameras[0].focus_distance == pytest.approx(3)


@pytest.mark.parametrize(
    ("mesh", "message"),
    [
        (SQUARE.replace("[0, 1, 2, 3]", "[0, 1, 2, 9]"), "expected indices below 4, the number of points, got 9"),
        (SQUARE.replace("[0, 1, 2, 3]", "[0, 1, 2]"), r"expected 3 corners of faces, .* got 4 \(faceVertexCounts\)"),
        (SQUARE.replace("(-1, -1, 0)", "(nan, 0, 0)"), "expected finite coordinates"),
        (SQUARE.replace("[4]", "[-4]"), "expected 4 corners of faces"),
        ("", "expected points and faces, got 0 points and 0 corners"),
        ("double3 xformOp:scale = (1e300, 1e300, 1)\n" + SQUARE, None),
    ],
)
def test_invalid_meshes_are_left_out(tmp_path: Path, mesh: str, message: str | None) -> None:
    if message is None:
        mesh += 'uniform token[] xformOpOrder = ["xformOp:scale"]'
        message = "expected finite positions in world space|expected a finite transform"
    with pytest.warns(EclatWarning, match=message):
        scene = load_usda(tmp_path, f'def Mesh "m" {{ {mesh} }}\ndef Sphere "ball" {{}}')
    assert [one.name for one in scene.meshes] == ["ball"]


@pytest.mark.parametrize(
    "data", [b"", b"#usda 1.0\n def { broken", b"PXR-USDC" + bytes(200), b"PK\3\4" + bytes(40), b"xyz"]
)
@pytest.mark.parametrize("suffix", [".usd", ".usda", ".usdc", ".usdz"])
def test_files_that_are_no_usd_are_refused(tmp_path: Path, data: bytes, suffix: str) -> None:
    path = tmp_path / f"a{suffix}"
    path.write_bytes(data)
    with pytest.raises(EclatError, match=r"a\.usd.?: expected a USD file, got an error: ") as error:
        eclat.load(path)
    assert "\n" not in str(error.value)


def test_a_missing_layer_is_a_warning(tmp_path: Path) -> None:
    with pytest.warns(EclatWarning, match="a.usda: USD reports: .*missing.usda"):
        load_usda(tmp_path, 'def Xform "x" (references = @missing.usda@) { def Sphere "s" {} }')


def test_layers_outside_of_the_root_folder_are_refused(tmp_path: Path) -> None:
    (tmp_path / "inside").mkdir()
    save_usda(tmp_path, 'def Xform "secret" { def Sphere "s" {} }', name="outside.usda")
    body = 'def Xform "x" (references = @../outside.usda@</secret>) {}'
    path = save_usda(tmp_path / "inside", body)
    assert len(eclat.load(path).meshes) == 1
    with pytest.raises(EclatError, match="expected a file below the root folder"):
        eclat.load(path, root=tmp_path / "inside")


def test_what_is_not_drawn_is_named_once(tmp_path: Path) -> None:
    body = 'def BasisCurves "a" {}\ndef BasisCurves "b" {}\ndef Sphere "s" {}'
    with pytest.warns(EclatWarning, match="prims of the type BasisCurves are not supported") as found:
        load_usda(tmp_path, body)
    assert len(found) == 1


def test_skeletons_are_named(tmp_path: Path) -> None:
    with pytest.warns(EclatWarning, match="skeletons are not supported: skinned meshes are shown as they were bound"):
        load_usda(tmp_path, 'def Skeleton "bones" {}\ndef Sphere "s" {}')


def test_damaged_values_are_left_out_with_a_message(tmp_path: Path) -> None:
    """A value that cannot be unpacked leaves its prim out, or its file is refused; nothing else is raised."""
    source = save_usda(tmp_path, f'def Mesh "m" {{ {SQUARE} }}\ndef Sphere "ball" {{ double radius = 3.25 }}')
    path = tmp_path / "whole.usdc"
    assert Sdf.Layer.FindOrOpen(str(source)).Export(str(path))
    data, refused = path.read_bytes(), 0
    for place in range(90, len(data), 61):
        damaged = tmp_path / f"at_{place}.usdc"
        damaged.write_bytes(data[:place] + bytes([data[place] ^ 0x85]) + data[place + 1 :])
        try:
            eclat.load(damaged)
        except EclatError:
            refused += 1
    assert refused > 3


def test_names_that_are_not_utf8_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.usda"
    path.write_bytes(b'#usda 1.0\ndef Sphere "a\x80b" {}\n')
    with pytest.raises(EclatError, match=r"a\.usda: expected a USD file, got an error: "):
        eclat.load(path)
