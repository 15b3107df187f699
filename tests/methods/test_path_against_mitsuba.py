# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""`path` against an independent renderer: Mitsuba 3 (`scalar_rgb`) on the same scenes, block by block.

Both render each scene several times with independent seeds; the means of blocks of pixels are compared by Student's t.
The threshold is chosen so that a true agreement fails once in 10⁶ runs of a scene.
"""

from __future__ import annotations

import numpy as np
import pytest
import scipy.stats

import eclat

mi = pytest.importorskip("mitsuba", reason="Mitsuba 3 is the oracle of these tests: pip install 'eclat[test]'")
mi.set_variant("scalar_rgb")

SIZE, BLOCK, RUNS = 24, 8, 6


def rgb(*c: float) -> dict:
    return {"type": "rgb", "value": list(c)}


def room(**extra: dict) -> dict:
    """Floor, back wall and one side wall, open to the front; what lights it comes in `extra`."""
    t = mi.ScalarTransform4f()
    white = {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": rgb(0.7, 0.6, 0.5)}}
    red = {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": rgb(0.6, 0.1, 0.1)}}
    scene = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": 8, "rr_depth": 100},
        "sensor": {
            "type": "perspective",
            "fov": 45,
            "to_world": t.look_at(origin=[0.3, 1.2, 4.5], target=[0, 0.8, 0], up=[0, 1, 0]),
            "film": {"type": "hdrfilm", "width": SIZE, "height": SIZE, "rfilter": {"type": "box"}},
            "sampler": {"type": "independent"},
        },
        "floor": {"type": "rectangle", "to_world": t.rotate([1, 0, 0], -90).scale(2), "bsdf": white},
        "back": {"type": "rectangle", "to_world": t.translate([0, 2, -2]).scale(2), "bsdf": white},
        "side": {"type": "rectangle", "to_world": t.translate([-2, 2, 0]).rotate([0, 1, 0], 90).scale(2), "bsdf": red},
    }
    scene.update(extra)
    return scene


def area_light(radiance: float = 12.0) -> dict:
    t = mi.ScalarTransform4f()
    return {
        "type": "rectangle",
        "to_world": t.translate([0.2, 3, 0.3]).rotate([1, 0, 0], 90).scale(0.5),
        "emitter": {"type": "area", "radiance": rgb(radiance, radiance, 0.8 * radiance)},
    }


def cube(bsdf: dict) -> dict:
    t = mi.ScalarTransform4f()
    return {"type": "cube", "to_world": t.translate([0.2, 0.61, 0]).rotate([0, 1, 0], 30).scale(0.6), "bsdf": bsdf}


def two_sided(bsdf: dict) -> dict:
    return {"type": "twosided", "bsdf": bsdf}


def scenes() -> dict[str, dict]:
    t = mi.ScalarTransform4f()
    matte = two_sided({"type": "diffuse", "reflectance": rgb(0.3, 0.5, 0.7)})
    # Bright on one side and above, so that a turned or mirrored image would show.
    rows, columns = np.mgrid[0:16, 0:32].astype(np.float32)
    texels = np.stack(
        [np.exp(-((columns - 22) ** 2 + (rows - 4) ** 2) / 12) * 9 + 0.2, columns / 40, rows / 20], axis=-1
    )
    gradient = {"type": "envmap", "bitmap": mi.Bitmap(texels.astype(np.float32))}
    sky = {"type": "constant", "radiance": rgb(0.5, 0.7, 1)}
    rough = {
        "type": "roughconductor",
        "distribution": "ggx",
        "alpha": 0.3,
        "eta": rgb(0.2, 0.9, 1.1),
        "k": rgb(3.9, 2.4, 2.2),
    }
    beckmann = dict(rough, distribution="beckmann", alpha=0.4)
    return {
        "area light, diffuse": room(light=area_light(), object=cube(matte)),
        "rough conductor, GGX": room(light=area_light(), object=cube(two_sided(rough))),
        "rough conductor, Beckmann": room(light=area_light(), object=cube(two_sided(beckmann))),
        "mirror": room(light=area_light(), object=cube(two_sided({"type": "conductor", "material": "none"}))),
        "point light": room(light={"type": "point", "position": [0.5, 2.5, 1], "intensity": rgb(8, 7, 6)}),
        "spot light": room(light={
            "type": "spot", "cutoff_angle": 40, "beam_width": 20, "intensity": rgb(20, 20, 20),
            "to_world": t.look_at(origin=[0, 3, 1], target=[0, 0, -0.5], up=[0, 0, 1]),
        }),
        "directional light": room(light={"type": "directional", "direction": [0.3, -1, -0.5], "irradiance": rgb(3, 3, 2)}),
        "constant environment": room(light=sky, object=cube(two_sided(rough))),
        "rough glass": room(light=sky, object=cube(
            {"type": "roughdielectric", "alpha": 0.4, "int_ior": 1.5, "distribution": "ggx"})),
        "glass": room(light=sky, object=cube({"type": "dielectric", "int_ior": 1.5})),
        "thin glass": room(light=sky, object=cube({"type": "thindielectric"})),
        "smooth plastic": room(light=area_light(), object=cube(two_sided(
            {"type": "plastic", "diffuse_reflectance": rgb(0.2, 0.5, 0.3), "nonlinear": True}))),
        "rough plastic": room(light=area_light(), object=cube(two_sided(
            {"type": "roughplastic", "diffuse_reflectance": rgb(0.2, 0.5, 0.3), "alpha": 0.3, "distribution": "ggx"}))),
        "blend": room(light=area_light(), object=cube(
            {"type": "blendbsdf", "weight": 0.3, "a": two_sided(rough), "b": matte})),
        "environment image": room(light=gradient, object=cube(matte)),
        "mask": room(light=area_light(), object=cube({
            "type": "mask", "opacity": 0.4, "bsdf": matte})),
    }  # fmt: skip


def blocks(image: np.ndarray) -> np.ndarray:
    n = SIZE // BLOCK
    return image.reshape(n, BLOCK, n, BLOCK, 3).mean(axis=(1, 3)).ravel()


@pytest.mark.parametrize("name", list(scenes()))
def test_path_agrees_with_mitsuba(name: str) -> None:
    description = scenes()[name]
    theirs_scene = mi.load_dict(description)
    ours_scene = eclat.load_dict(description)
    theirs = np.array([blocks(np.array(mi.render(theirs_scene, spp=128, seed=run))) for run in range(RUNS)])
    ours = np.array([
        blocks(eclat.render(ours_scene, eclat.Path(), samples=128, size=(SIZE, SIZE), max_depth=8, seed=run).pixels)
        for run in range(RUNS)
    ])  # fmt: skip
    # Welch: our stratified samples vary much less than theirs. A floor of 10⁻⁵ of the mean stands for float rounding.
    error = np.sqrt(theirs.var(0, ddof=1) / RUNS + ours.var(0, ddof=1) / RUNS) + 1e-5 * theirs.mean()
    t = np.abs(ours.mean(0) - theirs.mean(0)) / error
    limit = scipy.stats.t.isf(0.5e-6 / t.size, RUNS - 1)
    assert t.max() < limit, f"{name}: t = {t.max():.1f} over {limit:.1f}; ours {ours.mean(0)}, theirs {theirs.mean(0)}"
    # The means agree closely enough for a bias of a few percent to be seen at all.
    assert abs(ours.mean() / theirs.mean() - 1) < 0.02
