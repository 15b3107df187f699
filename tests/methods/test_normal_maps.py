# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Normal and bump maps against closed forms, against planes that are really turned, and against Mitsuba 3."""

from __future__ import annotations

import numpy as np
import pytest

import eclat
from eclat.scene import FloatArray, Material, Mesh, NormalMap, Texture, Value, grey, rgb
from support.planes import IRRADIANCE, UPRIGHT, rotation_to, seen_from_above, shine, square, unit

LIGHTS = [unit(0, 0, 1), unit(1, 0, 2), unit(-0.4, 1.1, 1.5), unit(0.3, -0.9, 1)]


def texture(image: np.ndarray, **settings: str) -> Value:
    return Value((1.0, 1.0, 1.0), Texture(np.asarray(image, np.float32), **settings))


def constant_map(x: float, y: float, z: float, scale: float = 1.0) -> NormalMap:
    """A normal map that says (x, y, z) everywhere."""
    texel = (np.array([x, y, z]) + 1) / 2
    return NormalMap(texture(np.tile(texel, (2, 2, 1))), "normal", scale)


def diffuse(normal_map: NormalMap | None) -> Material:
    return Material("diffuse", {"reflectance": grey(0.6)}, normal_map=normal_map)


def lambert(normal: FloatArray, light: FloatArray) -> float:
    return 0.6 / np.pi * IRRADIANCE * max(float(normal @ light), 0.0)


def expect(mesh: Mesh, normal: FloatArray) -> None:
    """The middle of `mesh` shines as Lambert's law says for `normal`, whatever the light."""
    for light in LIGHTS:
        assert shine(seen_from_above(mesh, light))[0, 0, 0] == pytest.approx(lambert(normal, light), rel=1e-4)


@pytest.mark.parametrize("scale", [1.0, 0.5])
def test_red_bends_along_u_and_green_up_in_the_image(scale: float) -> None:
    x, y, z = unit(0.3, 0.2, 1.0)
    bent = constant_map(x, y, z, scale)
    expect(square(diffuse(bent)), unit(scale * x, scale * y, z))
    # The image turned by a quarter: u along +y, its top towards −x.
    turned = np.roll(UPRIGHT, 1, axis=0)
    expect(square(diffuse(bent), uvs=turned), unit(-scale * y, scale * x, z))
    # Mirrored: u along −x.
    expect(square(diffuse(bent), uvs=UPRIGHT[[1, 0, 3, 2]]), unit(-scale * x, scale * y, z))


@pytest.mark.parametrize("handedness", [1.0, -1.0])
@pytest.mark.parametrize("degrees", [0.0, 90.0, 143.0])
def test_given_tangents_overrule_texture_coordinates(degrees: float, handedness: float) -> None:
    x, y, z = unit(0.3, 0.2, 1.0)
    t = np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees)), 0.0])
    b = handedness * np.cross([0, 0, 1], t)
    tangents = np.tile([*t, handedness], (4, 1))
    mesh = square(diffuse(constant_map(x, y, z)), tangents=tangents)
    expect(mesh, x * t + y * b + z * np.array([0, 0, 1.0]))


def test_tangents_are_interpolated_between_vertices() -> None:
    x, y, z = unit(0.5, 0.1, 1.0)
    left, right = unit(1, 0.2, 0), unit(0.1, 1, 0)
    tangents = np.array([[*(left if corner in (0, 3) else right), 1.0] for corner in range(4)])
    mesh = square(diffuse(constant_map(x, y, z)), tangents=tangents)
    light = LIGHTS[1]
    row = shine(seen_from_above(mesh, light, width=2), size=(9, 9))[4, :, 0]
    # Samples are spread over a pixel: the middle pixels' tangents stand for all of theirs.
    for i in range(9):
        at = (i + 0.5) / 9
        t = unit(*(left * (1 - at) + right * at))
        assert row[i] == pytest.approx(lambert(x * t + y * np.cross([0, 0, 1], t) + z * unit(0, 0, 1), light), rel=0.03)


def test_tangents_lie_in_the_plane_of_a_smooth_normal() -> None:
    """A smooth normal that leans, with a tangent that does not lie in its plane: the frame is made orthonormal."""
    normal, given = unit(0.2, -0.3, 1), unit(1, 0.3, 0)
    t = unit(*(given - normal * (given @ normal)))
    x, y, z = unit(0.2, 0.4, 1.0)
    mesh = square(
        diffuse(constant_map(x, y, z)), normals=np.tile(normal, (4, 1)), tangents=np.tile([*given, -1.0], (4, 1))
    )
    expect(mesh, x * t - y * np.cross(normal, t) + z * normal)


def test_the_back_shows_the_same_relief() -> None:
    """A bend is of the surface: from behind, its normal is the opposite one."""
    x, y, z = unit(0.3, 0.2, 1.0)
    mesh = square(diffuse(constant_map(x, y, z)))
    for light in LIGHTS:
        image = shine(seen_from_above(mesh, light * [1, 1, -1], side=-1))
        assert image[0, 0, 0] == pytest.approx(lambert(unit(-x, -y, -z), light * [1, 1, -1]), rel=1e-4)


@pytest.mark.parametrize(
    "material",
    [
        Material("diffuse", {"reflectance": grey(0.7)}),
        Material("phong", {"diffuse_reflectance": rgb(0.2, 0.3, 0.1), "exponent": grey(12)}),
        Material("conductor", {"alpha_u": grey(0.3)}),
        Material("plastic", {"alpha_u": grey(0.4)}),
        Material("metallic_roughness", {"roughness": grey(0.5), "metallic": grey(0.3)}),
    ],
    ids=lambda m: m.kind,
)
def test_a_constant_normal_map_looks_like_a_rotated_plane(material: Material) -> None:
    normal = unit(0.25, -0.15, 1)
    fields = {"kind": material.kind, "parameters": material.parameters}
    mapped = square(Material(**fields, normal_map=constant_map(*normal)))
    flat = square(Material(**fields))
    turned = Mesh(flat.positions @ rotation_to(normal).T, flat.triangles, flat.material)
    for light in LIGHTS:
        ours, theirs = (shine(seen_from_above(mesh, light))[0, 0] for mesh in (mapped, turned))
        assert ours == pytest.approx(theirs, rel=2e-4) and theirs.min() > 0


@pytest.mark.parametrize("slope", [(0.5, 0.0), (0.0, 0.5), (-0.3, 0.8)])
@pytest.mark.parametrize(
    "uvs",
    [UPRIGHT, UPRIGHT[[1, 0, 3, 2]], UPRIGHT @ np.array([[0.7, 0.2], [-0.3, 0.5]]) + [0.35, 0.1]],
    ids=["upright", "mirrored", "sheared"],
)
def test_a_ramp_of_heights_tilts_the_normal_by_its_slope(slope: tuple[float, float], uvs: FloatArray) -> None:
    """Heights a·u + b·v over the image: on the square they grow by a known slope, at whatever angle the image lies."""
    size, scale = 64, 0.8
    centres = (np.arange(size) + 0.5) / size
    ramp = 0.5 + 0.5 * (slope[0] * (centres[None] - 0.5) + slope[1] * (centres[:, None] - 0.5))
    material = diffuse(NormalMap(texture(ramp[:, :, None], wrap_u="clamp", wrap_v="clamp"), "bump", scale))
    # uv = (x, y) · A + offset over the square of side 2.
    to_uv = np.stack([uvs[1] - uvs[0], uvs[3] - uvs[0]]) / 2
    gradient = to_uv @ (0.5 * scale * np.array(slope))
    expect(square(material, uvs=uvs), unit(-gradient[0], -gradient[1], 1))


def test_a_bump_map_bends_a_smooth_normal_by_the_surface_gradient() -> None:
    """n' ∝ n − ∇h on a surface whose normal leans against its triangle [Blinn78]."""
    size, scale = 64, 0.6
    ramp = (np.arange(size) + 0.5) / size
    material = diffuse(NormalMap(texture(np.tile(ramp, (size, 1))[:, :, None]), "bump", scale))
    normal = unit(0.0, 0.3, 1.0)
    # The gradient lies along x, in the plane of the leaning normal: what is perpendicular to both stays.
    expect(square(material, normals=np.tile(normal, (4, 1))), unit(*(normal - np.array([scale / 2, 0, 0]))))


def mitsuba_relief(wrapper: dict, light_at: list[float]) -> dict:
    mi = pytest.importorskip("mitsuba", reason="Mitsuba 3 is the oracle of this test: pip install 'eclat[test]'")
    mi.set_variant("scalar_rgb")
    t = mi.ScalarTransform4f()
    return {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": 2},
        "sensor": {
            "type": "perspective", "fov": 40,
            "to_world": t.look_at(origin=[0.3, -0.5, 3.5], target=[0, 0, 0], up=[0, 1, 0]),
            "film": {"type": "hdrfilm", "width": 24, "height": 24, "rfilter": {"type": "box"}},
            "sampler": {"type": "multijitter"},
        },
        "light": {"type": "point", "position": light_at, "intensity": {"type": "rgb", "value": [9, 8, 7]}},
        "plane": {"type": "rectangle", "to_world": t.rotate([1, 0.3, 0], 10).scale([2, 2.4, 1]), "bsdf": wrapper},
    }  # fmt: skip


@pytest.mark.parametrize("kind", ["bumpmap", "normalmap"])
def test_reliefs_shine_as_in_mitsuba(kind: str) -> None:
    mi = pytest.importorskip("mitsuba", reason="Mitsuba 3 is the oracle of this test: pip install 'eclat[test]'")
    mi.set_variant("scalar_rgb")
    # Smooth waves, finely sampled, so that the two ways to take a derivative between texels agree.
    size = 256
    v, u = np.meshgrid((np.arange(size) + 0.5) / size, (np.arange(size) + 0.5) / size, indexing="ij")
    if kind == "bumpmap":
        image = (0.5 + 0.2 * np.sin(2 * np.pi * (2 * u + v)) + 0.15 * np.cos(2 * np.pi * (u - 2 * v)))[:, :, None]
    else:
        x, y = 0.35 * np.sin(2 * np.pi * (u + 2 * v)), 0.25 * np.cos(2 * np.pi * 2 * u) + 0.1
        tilt = np.stack([x, y, np.ones_like(x)], axis=2)
        image = 0.5 + 0.5 * tilt / np.linalg.norm(tilt, axis=2, keepdims=True)
    bitmap = {"type": "bitmap", "bitmap": mi.Bitmap(image.astype(np.float32)), "raw": True}
    nested = {"type": "diffuse", "reflectance": {"type": "rgb", "value": [0.8, 0.5, 0.4]}}
    relief = {"type": kind, "map" if kind == "bumpmap" else "normalmap": bitmap, "inner": nested}
    if kind == "bumpmap":
        relief["scale"] = 0.5
    # Mitsuba's own darkening of bumps at the terminator, which we do not imitate.
    plain = {"use_shadowing_function": False, "flip_invalid_normals": False}
    light = [0.8, 0.9, 1.6]
    bent = mi.load_dict(mitsuba_relief({"type": "twosided", "bsdf": relief | plain}, light))
    theirs = np.array(mi.render(bent, spp=256))
    scenes = (eclat.load_dict(mitsuba_relief({"type": "twosided", "bsdf": b}, light)) for b in (relief, nested))
    ours, flat = (eclat.render(s, eclat.Path(), samples=256, size=(24, 24), max_depth=2).pixels for s in scenes)
    assert np.abs(theirs - flat).mean() > 0.05 * theirs.mean(), "the map must show"
    # Both average smooth shading over the same pixels: there is hardly any noise.
    error = np.abs(ours - theirs) / (theirs + 0.05 * theirs.mean())
    assert error.max() < 0.005
