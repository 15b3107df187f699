# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Compressed glTF: what other encoders wrote against the uncompressed file, damage, and decoders that are missing."""

from __future__ import annotations

import json
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image
from scipy.spatial import cKDTree

from eclat.errors import EclatError, EclatWarning
from eclat.loaders.gltf import load_gltf
from eclat.scene import Mesh, Scene
from fuzz.mutations import glb
from support.compressed_files import COMPRESSED, ball, picture
from support.gltf_files import GltfFile

Change = Callable[[dict[str, Any]], None]
DIAMETER = 4.0
EXTENSION = "KHR_draco_mesh_compression"


def corners(mesh: Mesh) -> NDArray[np.float64]:
    """(3T, 12): position, normal, texture coordinates and colour of each corner of the triangles."""
    assert mesh.normals is not None and mesh.uvs is not None and mesh.colors is not None
    columns = np.column_stack([mesh.positions, mesh.normals, mesh.uvs, mesh.colors])
    corners: NDArray[np.float64] = columns[mesh.triangles].reshape(-1, 12)
    return corners


def triangles(mesh: Mesh) -> NDArray[np.float64]:
    """(T, 12): the mean of the columns of `corners` of each triangle, and so independent of which corner is first."""
    means: NDArray[np.float64] = corners(mesh).reshape(-1, 3, 12).mean(axis=1)
    return means


def parts_of(data: bytes) -> tuple[dict[str, Any], bytes]:
    """The JSON and the binary chunk of a GLB file."""
    length = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20 : 20 + length]), data[28 + length :]


def changed(folder: Path, name: str, change: Change) -> Path:
    """Write a compressed file with other JSON."""
    root, binary = parts_of((COMPRESSED / name).read_bytes())
    change(root)
    path = folder / "changed.glb"
    path.write_bytes(glb(json.dumps(root).encode(), binary))
    return path


@pytest.mark.parametrize(
    ("name", "bits", "normals"),
    [
        # The bits of a position are gltf-transform's defaults. A normal's octahedral map has 10 bits in Draco; its tangent space
        # is at most 2 wide and the map stretches by up to √3. The filter of meshopt has 8 bits.
        ("draco.glb", 14, 2 * 3**0.5 / 2**10),
        ("meshopt.glb", 14, 2 * 3**0.5 / 2**8),
        ("quantized.glb", 14, 2 * 3**0.5 / 2**10),
    ],
)
def test_decompressed_geometry_is_that_of_the_uncompressed_file(
    tmp_path: Path, name: str, bits: int, normals: float
) -> None:
    """Every triangle lies where one of the uncompressed file lies, within the quantization that the encoder states."""
    plain, packed = load_gltf(ball().save(tmp_path)), load_gltf(COMPRESSED / name)
    expected, got = triangles(plain.meshes[0]), triangles(packed.meshes[0])
    assert len(got) == len(expected)
    _, nearest = cKDTree(expected[:, :3]).query(got[:, :3])
    assert len(set(nearest)) == len(expected)
    errors = np.abs(got - expected[nearest]).max(axis=0)
    # The morph target at 0.5 is quantized as well, so positions err by half a step of the base and of the target.
    assert (errors[:3] < 1.0 * DIAMETER / 2**bits).all()
    assert (errors[3:6] < normals).all()
    assert (errors[6:8] < 1 / 2**12).all()
    assert (errors[8:] < 0.5 / 255 + 1e-6).all()
    # The front is the same: triangles turn their normals outwards.
    a, b, c = np.moveaxis(packed.meshes[0].positions[packed.meshes[0].triangles], 1, 0)
    assert (np.einsum("ij,ij->i", np.cross(b - a, c - a), got[:, 3:6]) > 0).all()
    assert packed.meshes[0].positions[:, 1].max() == pytest.approx(1 + 2 + 2 + 0.5, abs=1e-3)
    assert packed.warnings == ()


def test_draco_is_not_decoded_if_the_file_has_the_uncompressed_data(tmp_path: Path) -> None:
    file = GltfFile()
    file.mesh_node(file.primitive(extensions={EXTENSION: {"bufferView": 99, "attributes": {}}}))
    assert len(load_gltf(file.save(tmp_path)).meshes[0].triangles) == 1


def draco_of(root: dict[str, Any]) -> dict[str, Any]:
    found: dict[str, Any] = root["meshes"][0]["primitives"][0]["extensions"][EXTENSION]
    return found


def accessor_of(root: dict[str, Any], attribute: str) -> dict[str, Any]:
    found: dict[str, Any] = root["accessors"][root["meshes"][0]["primitives"][0]["attributes"][attribute]]
    return found


def meshopt_of(root: dict[str, Any], number: int = 0) -> dict[str, Any]:
    views = [view for view in root["bufferViews"] if "extensions" in view]
    found: dict[str, Any] = views[number]["extensions"]["EXT_meshopt_compression"]
    return found


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda root: draco_of(root).pop("bufferView"), r"as 'bufferView', but it is missing"),
        (lambda root: draco_of(root).update(bufferView=0), "the geometry cannot be decompressed: "),
        (lambda root: draco_of(root)["attributes"].update(POSITION=77), "expected 'POSITION' in the compressed data"),
        (lambda root: draco_of(root)["attributes"].update(_ODD=0), "expected attributes of the primitive, got '_ODD'"),
        (lambda root: accessor_of(root, "NORMAL").update(count=7), r"expected 7 × 3 values of NORMAL .* got \d+ × 3"),
        (lambda root: accessor_of(root, "NORMAL").update(type="VEC2"), r"expected \d+ × 2 values of NORMAL"),
        (lambda root: accessor_of(root, "NORMAL").update(componentType=5123), "expected values that fit uint16"),
        (lambda root: accessor_of(root, "POSITION").update(count=1 << 40), "expected at most 512 MiB of geometry"),
    ],
)
def test_damage_of_draco_is_named(tmp_path: Path, change: Change, message: str) -> None:
    with pytest.raises(EclatError, match=message):
        import eclat

        eclat.load(changed(tmp_path, "draco.glb", change))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda root: meshopt_of(root).pop("buffer"), "expected the index of a buffer as 'buffer', but it is missing"),
        (lambda root: meshopt_of(root).update(mode="STRIPS"), "expected a mode of .* got 'STRIPS' and 'NONE'"),
        (lambda root: meshopt_of(root, 1).update(filter="SHARP"), "and 'SHARP'"),
        (
            lambda root: meshopt_of(root).update(count=4),
            r"expected \d+ bytes, as the buffer view has, got 4 elements of",
        ),
        (lambda root: meshopt_of(root).update(byteLength=9), "the data cannot be decompressed"),
        (lambda root: meshopt_of(root).update(byteLength=1 << 30), "expected a range within the"),
        (lambda root: meshopt_of(root).update(mode="ATTRIBUTES"), "the data cannot be decompressed"),
    ],
)
def test_damage_of_meshopt_is_named(tmp_path: Path, change: Change, message: str) -> None:
    with pytest.raises(EclatError, match=message):
        load_gltf(changed(tmp_path, "meshopt.glb", change))


def test_a_claim_of_gigabytes_is_refused_before_they_are_allocated(tmp_path: Path) -> None:
    import eclat

    def grow(root: dict[str, Any]) -> None:
        for view in root["bufferViews"]:
            if "extensions" in view:
                packed = view["extensions"]["EXT_meshopt_compression"]
                packed["count"] = 3 << 34
                view["byteLength"] = packed["count"] * packed["byteStride"]

    with pytest.raises(EclatError, match="expected at most 512 MiB of geometry"):
        eclat.load(changed(tmp_path, "meshopt.glb", grow))


@pytest.mark.parametrize(("name", "module"), [("draco.glb", "DracoPy"), ("meshopt.glb", "meshopt")])
def test_a_missing_decoder_is_named_with_what_installs_it(
    monkeypatch: pytest.MonkeyPatch, name: str, module: str
) -> None:
    monkeypatch.setitem(__import__("sys").modules, module, None)
    with pytest.raises(EclatError, match=r"pip install 'eclat\[files\]'"):
        load_gltf(COMPRESSED / name)


def with_basisu(folder: Path, name: str) -> Scene:
    """Load a triangle whose texture is one KTX2 file."""
    file = GltfFile()
    file.append("images", {"bufferView": file.view((COMPRESSED / name).read_bytes()), "mimeType": "image/ktx2"})
    file.append("textures", {"extensions": {"KHR_texture_basisu": {"source": 0}}})
    material = file.append("materials", {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}})
    primitive = file.primitive(material=material)
    primitive["attributes"]["TEXCOORD_0"] = file.accessor([[0, 0], [1, 0], [0, 1]])
    file.mesh_node(primitive)
    file.json["extensionsUsed"] = file.json["extensionsRequired"] = ["KHR_texture_basisu"]
    return load_gltf(file.save(folder))


def test_a_texture_of_basis_universal_is_its_source(tmp_path: Path) -> None:
    texture = with_basisu(tmp_path, "uastc.ktx2").meshes[0].material.parameters["base_color"].texture
    assert texture is not None and texture.srgb
    assert np.abs(texture.image.astype(float) - picture()).mean() < 1


def test_a_texture_without_its_decoder_is_one_warning(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "opengl_basisu", None)
    with pytest.warns(
        EclatWarning, match=r"images\[0\]: KTX2 images can be .* 'eclat\[files\]'.* checkerboard"
    ) as found:
        scene = with_basisu(tmp_path, "uastc.ktx2")
    assert len(found) == 1 and len(scene.meshes[0].triangles) == 1


def test_a_png_is_preferred_to_basis_universal(tmp_path: Path) -> None:
    file = GltfFile()
    index = file.texture(picture())
    file.append("images", {"bufferView": 0, "mimeType": "image/ktx2"})
    file.json["textures"][index]["extensions"] = {"KHR_texture_basisu": {"source": 1}}
    material = file.append("materials", {"pbrMetallicRoughness": {"baseColorTexture": {"index": index}}})
    file.mesh_node(file.primitive(material=material))
    with pytest.warns(EclatWarning, match="TEXCOORD_0, which the primitive does not have"):
        texture = load_gltf(file.save(tmp_path)).meshes[0].material.parameters["base_color"].texture
    assert texture is not None and np.array_equal(texture.image, picture())


def test_the_pictures_of_these_tests_are_what_the_encoders_got(tmp_path: Path) -> None:
    """The PNG inside of a compressed file is the picture, so that the comparisons are of the same source."""
    texture = load_gltf(COMPRESSED / "draco.glb").meshes[0].material.parameters["base_color"].texture
    assert texture is not None and np.array_equal(texture.image, picture())
    assert Image.fromarray(picture(alpha=True)).mode == "RGBA"
