# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""USD scenes as a user has them: an archive with textures against the same scene built in Python, and the commands."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from pxr import Sdf, UsdUtils

import eclat
from eclat.scene import Camera, Material, Mesh, Scene, Texture, Value, grey, look_at, rgb
from support.usd_files import save_usda

CHECKS = (
    (np.kron([[1, 0, 1, 0], [0, 1, 0, 1]], np.ones((4, 4))) * 160 + 60).astype(np.uint8)[..., None].repeat(3, axis=2)
)

ROOM = """
def Material "checks" {
    token outputs:surface.connect = </checks/s.outputs:surface>
    def Shader "s" {
        uniform token info:id = "UsdPreviewSurface"
        color3f inputs:diffuseColor.connect = </checks/t.outputs:rgb>
        float inputs:roughness = 0.4
        token outputs:surface
    }
    def Shader "t" {
        uniform token info:id = "UsdUVTexture"
        asset inputs:file = @checks.png@
        float2 inputs:st.connect = </checks/r.outputs:result>
        float3 outputs:rgb
    }
    def Shader "r" {
        uniform token info:id = "UsdPrimvarReader_float2"
        string inputs:varname = "st"
        float2 outputs:result
    }
}
def Xform "room" {
    def Mesh "floor" (prepend apiSchemas = ["MaterialBindingAPI"]) {
        int[] faceVertexCounts = [4]
        int[] faceVertexIndices = [0, 1, 2, 3]
        point3f[] points = [(-200, -200, 0), (200, -200, 0), (200, 200, 0), (-200, 200, 0)]
        texCoord2f[] primvars:st = [(0, 0), (3, 0), (3, 2), (0, 2)] (interpolation = "vertex")
        uniform token subdivisionScheme = "none"
        rel material:binding = </checks>
    }
    def Cube "box" {
        double size = 80
        color3f[] primvars:displayColor = [(0.7, 0.2, 0.1)]
        double3 xformOp:translate = (30, 0, 40)
        uniform token[] xformOpOrder = ["xformOp:translate"]
    }
}
def RectLight "lamp" {
    float inputs:width = 100
    float inputs:height = 60
    float inputs:intensity = 40
    color3f inputs:color = (1, 0.9, 0.8)
    double3 xformOp:translate = (0, 0, 250)
    uniform token[] xformOpOrder = ["xformOp:translate"]
}
def Camera "eye" {
    float horizontalAperture = 32
    float verticalAperture = 24
    float focalLength = 24
    double3 xformOp:translate = (0, -500, 200)
    float xformOp:rotateX = 70
    uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateX"]
}
"""
HEAD = 'upAxis = "Z"\n    metersPerUnit = 0.01\n    defaultPrim = "room"'


def same_scene() -> Scene:
    """The room built of arrays, in metres; texture coordinates have v downwards."""
    corners = np.array([[-2, -2, 0], [2, -2, 0], [2, 2, 0], [-2, 2, 0]], float)
    quad = np.array([[0, 1, 2], [0, 2, 3]])
    checks = Value((1.0, 1.0, 1.0), Texture(CHECKS, srgb=True))
    floor = Material(
        "metallic_roughness",
        {"base_color": checks, "roughness": Value((0.4,) * 3, square=True), "metallic": grey(0), "ior": grey(1.5)},
    )
    uvs = np.array([[0, 1], [3, 1], [3, -1], [0, -1]], float)
    cube = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float) * 0.4 + [0.3, 0, 0.4]
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = np.array([[a, b, c] for p, q, r, s in sides for a, b, c in ((p, q, r), (p, r, s))])
    lamp = np.array([[-0.5, -0.3, 2.5], [-0.5, 0.3, 2.5], [0.5, 0.3, 2.5], [0.5, -0.3, 2.5]])
    glow = Material("diffuse", {"reflectance": grey(0)}, two_sided=False, back_culled=True, emission=rgb(40, 36, 32))
    red = Material("diffuse", {"reflectance": rgb(0.7, 0.2, 0.1)})
    # Turned by 70° about x, a camera looks along (0, sin 70°, −cos 70°).
    angle = np.radians(70)
    eye = np.array([0, -5, 2.0])
    target = eye + np.array([0, np.sin(angle), -np.cos(angle)])
    to_world = look_at(tuple(eye), tuple(target), (0, 0, 1))
    camera = Camera(to_world, fov=2 * float(np.degrees(np.arctan(16 / 24))), fov_axis="x")
    meshes = (Mesh(corners, quad, floor, uvs=uvs), Mesh(cube, faces, red), Mesh(lamp, quad, glow))
    return Scene(meshes, cameras=(camera,), up=(0, 0, 1), photometric=True)


def archive(folder: Path) -> Path:
    """The room as a .usdz with its texture inside; the loose files are removed."""
    Image.fromarray(CHECKS).save(folder / "checks.png")
    source = save_usda(folder, ROOM, HEAD, name="room.usda")
    path = folder / "room.usdz"
    assert UsdUtils.CreateNewUsdzPackage(Sdf.AssetPath(str(source)), str(path))
    for name in ("checks.png", "room.usda"):
        (folder / name).unlink()
    return path


def test_an_archive_gives_the_picture_of_the_same_scene_in_python(tmp_path: Path) -> None:
    scene = eclat.load(archive(tmp_path))
    assert scene.warnings == () and scene.photometric and scene.up == (0, 0, 1)
    settings = {"size": (48, 36), "samples": 256, "max_depth": 4, "threads": 2, "check": False}
    got = np.asarray(eclat.render(scene, "path", **settings).pixels)
    expected = np.asarray(eclat.render(same_scene(), "path", **settings).pixels)
    assert expected.mean() > 0.1
    assert got.mean(axis=(0, 1)) == pytest.approx(expected.mean(axis=(0, 1)), rel=5e-3)
    # The texture, the box and the lamp are where they should be: blocks of 6 × 6 pixels agree within noise.
    blocks = [image.reshape(6, 6, 8, 6, 3).mean(axis=(1, 3)) for image in (got, expected)]
    np.testing.assert_allclose(blocks[0], blocks[1], rtol=0.05, atol=0.02)


@pytest.mark.parametrize("name", ["room.usda", "room.usdc", "room.usd"])
def test_all_encodings_are_the_same_scene(tmp_path: Path, name: str) -> None:
    Image.fromarray(CHECKS).save(tmp_path / "checks.png")
    source = save_usda(tmp_path, ROOM, HEAD, name="source.usda")
    assert Sdf.Layer.FindOrOpen(str(source)).Export(str(tmp_path / name))
    scene, whole = eclat.load(tmp_path / name), eclat.load(archive(tmp_path))
    for a, b in zip(scene.meshes, whole.meshes, strict=True):
        assert np.array_equal(a.positions, b.positions) and np.array_equal(a.triangles, b.triangles)


def test_the_commands_take_an_archive(tmp_path: Path) -> None:
    path = archive(tmp_path)
    environment = {**os.environ, "PYTHONPATH": str(Path(eclat.__file__).parents[1])}

    def run(*arguments: str) -> str:
        done = subprocess.run(
            [sys.executable, "-m", "eclat", *arguments], cwd=tmp_path, env=environment, capture_output=True, text=True
        )
        assert done.returncode == 0, done.stderr
        return done.stdout + done.stderr

    told = run("info", str(path))
    assert "floor" in told or "3" in told
    run("render", str(path), "--size", "16x12", "--samples", "2", "--method", "path", "-o", "a.png")
    assert (tmp_path / "a.png").stat().st_size > 100
