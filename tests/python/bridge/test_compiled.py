# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A scene on its way into the core: the shift that keeps digits far from the origin, what is shared and kept, and what a
fingerprint sees."""

from __future__ import annotations

import gc
import weakref
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

import eclat
from eclat import _core
from eclat.bridge.compiled import compiled, fingerprint
from eclat.scene import MATERIAL_KINDS, DirectionalLight, Environment, Material, Mesh, PointLight, Scene, Texture, Value
from eclat.scenes import build
from support.similarity import Similarity


@pytest.fixture(scope="module")
def cornell() -> Scene:
    return build("cornell-box")


def moved(scene: Scene, *by: float) -> Scene:
    return Similarity(shift=np.array(by)).scene(scene)


def test_a_scene_near_the_origin_is_not_shifted(cornell: Scene) -> None:
    assert not compiled(cornell).center.any()
    assert not compiled(moved(cornell, 1.0, 2.0, 3.0)).center.any()


def test_a_scene_far_from_the_origin_is_shifted_to_its_middle(cornell: Scene) -> None:
    far = compiled(moved(cornell, 1e6, -2e6, 3e6))
    low = np.min([np.min(m.positions, axis=0) for m in cornell.meshes], axis=0)
    high = np.max([np.max(m.positions, axis=0) for m in cornell.meshes], axis=0)
    np.testing.assert_allclose(far.center, (low + high) / 2 + [1e6, -2e6, 3e6], rtol=0, atol=1e-9)
    # A millimetre is lost in float32 at 3000 km, and kept in the shifted frame.
    point = far.center + np.array([1e-3, 0, -1e-3])
    assert np.float32(point[2]) == np.float32(far.center[2])
    inside = far.to_core(point[None])
    assert inside.dtype == np.float32 and inside.shape == (1, 3)
    np.testing.assert_allclose(inside, [[1e-3, 0, -1e-3]], atol=1e-9)


def test_meshes_lights_and_camera_are_shifted_alike(cornell: Scene) -> None:
    """By a sum of powers of two, which costs positions no digit: the picture's bits stay but for the last."""
    lit = replace(cornell, lights=(PointLight((0.3, 0.5, 0.2), (1.0, 2.0, 3.0)),))
    here, there = (
        eclat.render(scene, eclat.Path(), size=(24, 24), samples=4).pixels
        for scene in (lit, moved(lit, 2.0**20, -(2.0**21), 2.0**19))
    )
    np.testing.assert_allclose(there, here, rtol=1e-3, atol=1e-4)
    assert here.mean() > 0.1


def test_a_scene_without_meshes_has_no_shift() -> None:
    sky = Scene((), (), Environment(np.ones((1, 1, 3), np.float32)), ())
    assert not compiled(sky).center.any()


def test_positions_that_are_not_finite_are_named(cornell: Scene) -> None:
    bad = np.array(cornell.meshes[0].positions, np.float64)
    bad[1, 2] = np.inf
    scene = replace(cornell, meshes=(replace(cornell.meshes[0], positions=bad), *cornell.meshes[1:]))
    with pytest.raises(eclat.EclatError, match="mesh 0: position 1 is not finite"):
        compiled(scene)


def test_a_scene_is_compiled_once_and_kept_no_longer_than_it_lives() -> None:
    scene = build("furnace")
    first = compiled(scene)
    assert compiled(scene) is first
    assert compiled(build("furnace")) is not first
    alive = weakref.ref(first)
    del scene, first
    gc.collect()
    assert alive() is None


def test_a_camera_s_matrix_must_be_finite(cornell: Scene) -> None:
    for matrix in (np.full((4, 4), np.nan), np.eye(3)):
        with pytest.raises(eclat.EclatError, match="to_world must be a finite 4×4 matrix"):
            compiled(cornell).camera(replace(cornell.cameras[0], to_world=matrix), (4, 4))


def textured() -> Scene:
    """A triangle with a texture, a light of each simple kind and an environment."""
    image = np.arange(12, dtype=np.uint8).reshape(2, 2, 3)
    material = Material("diffuse", {"reflectance": Value((1.0, 1.0, 1.0), Texture(image))}, name="paint")
    positions, triangles = np.eye(3), np.array([[0, 1, 2]])
    mesh = Mesh(positions, triangles, material, uvs=np.eye(3)[:, :2], name="leaf")
    lights = PointLight((0.0, 0.0, 2.0), (1.0,) * 3), DirectionalLight((0.0, 0.0, -1.0), (1.0,) * 3)
    return Scene((mesh,), lights, Environment(np.ones((1, 2, 3), np.float32)), build("cornell-box").cameras)


def mesh_with(scene: Scene, **changes: object) -> Scene:
    return replace(scene, meshes=(replace(scene.meshes[0], **changes),))  # type: ignore[arg-type]


def material_with(scene: Scene, **changes: object) -> Scene:
    return mesh_with(scene, material=replace(scene.meshes[0].material, **changes))  # type: ignore[arg-type]


def texture_with(scene: Scene, **changes: object) -> Scene:
    value = scene.meshes[0].material.parameters["reflectance"]
    assert value.texture is not None
    changed = replace(value, texture=replace(value.texture, **changes))  # type: ignore[arg-type]
    return material_with(scene, parameters={"reflectance": changed})


def nudged(array: object) -> np.ndarray:
    out = np.array(array)
    out.flat[-1] += 1
    return out


CHANGES: dict[str, Callable[[Scene], Scene]] = {
    "a vertex": lambda s: mesh_with(s, positions=nudged(s.meshes[0].positions)),
    "the order of corners": lambda s: mesh_with(s, triangles=np.array([[0, 2, 1]])),
    "a uv": lambda s: mesh_with(s, uvs=nudged(s.meshes[0].uvs)),
    "normals": lambda s: mesh_with(s, normals=np.tile([0.0, 0, 1], (3, 1))),
    "a texel": lambda s: texture_with(s, image=nudged(s.meshes[0].material.parameters["reflectance"].texture.image)),  # type: ignore[union-attr]
    "a wrap": lambda s: texture_with(s, wrap_u="clamp"),
    "the encoding": lambda s: texture_with(s, srgb=True),
    "both sides": lambda s: material_with(s, two_sided=not s.meshes[0].material.two_sided),
    "the kind": lambda s: material_with(s, kind="mirror", parameters={}),
    "an emission": lambda s: material_with(s, emission=Value((1.0, 1.0, 1.0))),
    "an intensity": lambda s: replace(s, lights=(replace(s.lights[0], intensity=(1.0, 1.0, 1.1)), s.lights[1])),  # type: ignore[call-arg]
    "a lamp less": lambda s: replace(s, lights=s.lights[:1]),
    "the sky": lambda s: replace(s, environment=Environment(np.full((1, 2, 3), 2, np.float32))),
    "no sky": lambda s: replace(s, environment=None),
    "a turn of the sky": lambda s: replace(s, environment=replace(s.environment, to_world=np.eye(3)[[1, 2, 0]])),  # type: ignore[type-var]
    "a mesh twice": lambda s: replace(s, meshes=s.meshes * 2),
}


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES.keys())
def test_a_fingerprint_changes_with_everything_that_affects_light(change: Callable[[Scene], Scene]) -> None:
    assert fingerprint(change(textured())) != fingerprint(textured())


def test_a_fingerprint_depends_on_values_but_not_on_cameras_or_names() -> None:
    scene = textured()
    first = fingerprint(scene)
    assert len(first) == 32 and first == fingerprint(textured())  # other objects, the same values
    assert fingerprint(replace(scene, cameras=(), name="other", warnings=("a word",))) == first
    assert fingerprint(material_with(mesh_with(scene, name="branch"), name="ink")) == first


def test_parameters_of_materials_have_the_same_names_in_the_core() -> None:
    assert set(MATERIAL_KINDS) == {kind.name for kind in _core.MaterialKind}
    for kind, names in MATERIAL_KINDS.items():
        assert list(names) == _core.parameter_names(_core.MaterialKind[kind])
    with pytest.raises(ValueError, match="expected the name of a parameter of its kind, got sheen"):
        _core.Material().set("sheen", _core.SceneBuilder().value(
            (0.0, 0.0, 0.0), texture=-1, channel=-1, uv_set=0, uv_transform=(1.0, 0.0, 0.0, 0.0, 1.0, 0.0), invert=False,
            square=False,
        ))  # fmt: skip
