# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Small files take little memory, whatever they ask for: their geometry and images are counted before they are made.

Each file is loaded in a process of its own, which tells the most memory that it had. Before there were budgets, most of
these files of under 1 MB took more than 2 GB.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from eclat.loaders.budget import ALLOWANCE, GROWTH, check, count_file, geometry_budget, spend
from eclat.loaders.parts import LimitError
from support.gltf_files import GltfFile

MOST = 1000
"""The largest number of megabytes that a file of under 1 MB may take: the allowance of geometry or of images, as much again
for what exists only while it is read, and `GROWTH` for each byte of the file."""

LOAD = """
import resource, sys, warnings
import eclat
from eclat.scenes import build
from eclat.stage.defaults import complete
def peak():
    return int(next(line for line in open("/proc/self/status") if line.startswith("VmHWM")).split()[1]) >> 10
resource.setrlimit(resource.RLIMIT_AS, (6 << 30, 6 << 30))
warnings.simplefilter("ignore")
before = peak()
try:
    if sys.argv[1].endswith(".gif"):
        complete(build("cornell-box"), environment=sys.argv[1])
    else:
        eclat.load(sys.argv[1])
    word = "loaded"
except eclat.EclatError as error:
    word = "refused " + str(error)
print(peak() - before, word)
"""


def taken(path: Path) -> tuple[int, str]:
    """Load a file elsewhere. Returns the megabytes that it took at most, and what became of it."""
    assert path.stat().st_size < 1 << 20
    run = subprocess.run([sys.executable, "-c", LOAD, path], check=True, capture_output=True, text=True)
    megabytes, _, word = run.stdout.strip().partition(" ")
    return int(megabytes), word


def many_primitives(folder: Path) -> Path:
    """3,000 primitives share one accessor of 60,000 vertices."""
    file = GltfFile()
    positions = np.random.default_rng(1).random((60000, 3), np.float32)
    file.mesh_node()
    file.json["meshes"][0]["primitives"] = [{"attributes": {"POSITION": file.accessor(positions)}}] * 3000
    return file.save(folder)


def many_indices(folder: Path) -> Path:
    """3,000 primitives share one accessor of 600,000 indices of a byte."""
    file = GltfFile()
    random = np.random.default_rng(1)
    positions = file.accessor(random.random((250, 3)))
    indices = file.accessor(random.integers(0, 250, 600000), "u1")
    file.mesh_node()
    file.json["meshes"][0]["primitives"] = [{"attributes": {"POSITION": positions}, "indices": indices}] * 3000
    return file.save(folder)


def accessors_without_data(folder: Path) -> Path:
    """300 primitives have a position for each of a million vertices, and no data."""
    file = GltfFile()
    file.mesh_node()
    primitives = []
    for _ in range(300):
        index = file.append("accessors", {"componentType": 5126, "type": "VEC3", "count": 1 << 20})
        primitives.append({"attributes": {"POSITION": index}})
    file.json["meshes"][0]["primitives"] = primitives
    return file.save(folder)


def invalid_primitives(folder: Path) -> Path:
    """20 primitives have a million positions each, and tangents of a wrong type."""
    file = GltfFile()
    file.mesh_node()
    position = file.append("accessors", {"componentType": 5126, "type": "VEC3", "count": 1 << 20})
    attributes = {"POSITION": position, "NORMAL": position, "TANGENT": position}
    file.json["meshes"][0]["primitives"] = [{"attributes": attributes}] * 20
    return file.save(folder)


def strided_accessors(folder: Path) -> Path:
    """2,000 accessors read the same interleaved buffer view."""
    file = GltfFile()
    file.mesh_node()
    view = file.json["accessors"][file.accessor(np.zeros((60000, 3)))]["bufferView"]
    file.json["bufferViews"][view]["byteStride"] = 16
    accessor = {"bufferView": view, "componentType": 5126, "type": "VEC3", "count": 44000}
    file.json["meshes"][0]["primitives"] = [
        {"attributes": {"POSITION": file.append("accessors", dict(accessor))}} for _ in range(2000)
    ]
    return file.save(folder)


def many_nodes(folder: Path) -> Path:
    """3,000 nodes have one mesh of 60,000 vertices."""
    file = GltfFile()
    node = file.mesh_node()
    positions = np.random.default_rng(1).random((60000, 3), np.float32)
    file.json["meshes"][0]["primitives"] = [{"attributes": {"POSITION": file.accessor(positions)}}]
    file.json["nodes"] += [dict(file.json["nodes"][node]) for _ in range(3000)]
    return file.save(folder)


def xml(folder: Path, *shapes: str) -> Path:
    path = folder / "scene.xml"
    path.write_text(f'<scene version="3.0.0">{"".join(shapes)}</scene>')
    return path


def spheres(folder: Path) -> Path:
    return xml(folder, *['<shape type="sphere"/>'] * 40000)


def instances(folder: Path) -> Path:
    """18,000 instances of a sphere with 16,000 triangles."""
    group = '<shape type="shapegroup" id="g"><shape type="ply"><string name="filename" value="m.ply"/></shape></shape>'
    write_ply(folder / "m.ply", 20000)
    return xml(folder, group, *['<shape type="instance"><ref id="g"/></shape>'] * 18000)


def one_mesh_file_many_times(folder: Path) -> Path:
    write_ply(folder / "m.ply", 20000)
    return xml(folder, *['<shape type="ply"><string name="filename" value="m.ply"/></shape>'] * 5000)


def write_ply(path: Path, vertices: int) -> None:
    """Write a binary file with as many vertices as triangles."""
    faces = np.zeros(vertices, [("count", "u1"), ("corners", "<i4", 3)])
    random = np.random.default_rng(1)
    faces["count"], faces["corners"] = 3, random.integers(0, vertices, (vertices, 3))
    header = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\n"
        f"property float z\nelement face {vertices}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    path.write_bytes(header.encode() + random.random((vertices, 3), np.float32).tobytes() + faces.tobytes())


def included_many_times(folder: Path) -> Path:
    """900 includes of a file of 20,000 shapes."""
    xml(folder, *['<shape type="rectangle"/>'] * 20000).rename(folder / "part.xml")
    return xml(folder, *['<include filename="part.xml"/>'] * 900)


def images_of_one_bit(folder: Path) -> Path:
    """Ten images of 120 million texels, in files of 15 kB."""
    textures = []
    for i in range(10):
        Image.new("1", (30000, 4000)).save(folder / f"{i}.png")
        texture = f'<texture type="bitmap" name="reflectance"><string name="filename" value="{i}.png"/></texture>'
        textures.append(f'<shape type="rectangle"><bsdf type="diffuse">{texture}</bsdf></shape>')
    return xml(folder, *textures)


def large_gif(folder: Path) -> Path:
    """An environment of 130 million texels in 100 kB."""
    Image.new("P", (16000, 8000)).save(folder / "sky.gif")
    return folder / "sky.gif"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("make", "fate"),
    [
        (many_primitives, "refused scene.glb, meshes[0].primitives"),
        (many_indices, "refused scene.glb, meshes[0].primitives"),
        (accessors_without_data, "refused scene.glb, meshes[0].primitives"),
        (invalid_primitives, "refused scene.glb, accessors[1]: expected VEC4"),
        (strided_accessors, "refused scene.glb, meshes[0].primitives"),
        (many_nodes, "refused scene.glb, meshes[0].primitives"),
        (spheres, "loaded"),
        (instances, 'refused scene.xml:1 <shape type="instance">'),
        (one_mesh_file_many_times, 'refused scene.xml:1 <shape type="ply">'),
        (included_many_times, "refused part.xml:1 <shape"),
        (images_of_one_bit, "loaded"),
        (large_gif, "refused environment: "),
    ],
)
def test_small_files_take_little_memory(make: Callable[[Path], Path], fate: str, tmp_path: Path) -> None:
    megabytes, word = taken(make(tmp_path))
    assert megabytes < MOST
    assert word.startswith(fate)


def test_a_file_counts_once_and_geometry_adds_up() -> None:
    with geometry_budget() as budget:
        for _ in range(3):
            count_file(Path("a.ply"), 10)
        count_file(Path("b.ply"), 1)
        assert budget.allowed == ALLOWANCE + 11 * GROWTH
        spend(ALLOWANCE, "one")
        spend(11 * GROWTH, "two")
        check(0, "three")
        with pytest.raises(LimitError, match="four: expected at most 512 MiB of geometry"):
            spend(1, "four")
        assert budget.taken == budget.allowed


def test_without_a_load_nothing_is_limited() -> None:
    spend(1 << 60, "anything")
