# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The geometry of Blender's evaluated objects as arrays, and as meshes in world space."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from eclat.scene import Mesh

from .materials import Made
from .notices import Notices


@dataclass(frozen=True, eq=False)
class Part:
    """The triangles of one material of an object, in its own space; arrays as those of `eclat.scene.Mesh`, but with
    coordinates of all UV maps by name. `loops` (V,) says which corner of Blender's mesh each vertex is."""

    positions: np.ndarray
    triangles: np.ndarray
    normals: np.ndarray | None
    uvs: dict[str, np.ndarray]
    colors: np.ndarray | None
    tangents: dict[str, np.ndarray]
    slot: int
    loops: np.ndarray


def read_parts(
    mesh: Any, tangent_maps: tuple[str, ...] = (), notices: Notices | None = None, where: str = ""
) -> list[Part]:
    """Read the triangles of a Blender mesh, one part for each material that its faces use.

    Tangents are computed for the UV maps in `tangent_maps` ("" is that which renders).
    """
    mesh.calc_loop_triangles()
    count, corners = len(mesh.loop_triangles), len(mesh.loops)
    if count == 0:
        return []
    loops = _array(mesh.loop_triangles, "loops", count * 3, np.int32).reshape(-1, 3)
    slots = _array(mesh.loop_triangles, "material_index", count, np.int32)
    places = _array(mesh.vertices, "co", len(mesh.vertices) * 3).reshape(-1, 3)
    vertices = _array(mesh.loops, "vertex_index", corners, np.int32)
    normals = _array(mesh.corner_normals, "vector", corners * 3).reshape(-1, 3)
    uvs = _uv_maps(mesh, corners)
    colors = _colors(mesh, vertices)
    tangents = _tangents(mesh, tangent_maps, corners, notices, where)
    found = []
    for slot in np.unique(slots):
        own = loops[slots == slot]
        columns = [vertices[:, None].astype(np.float32), normals, *uvs.values(), *tangents.values()]
        columns += [colors] if colors is not None else []
        chosen, triangles = _welded(own, np.hstack(columns))
        found.append(
            Part(
                places[vertices[chosen]].astype(np.float64),
                triangles,
                normals[chosen] if _is_smooth(own, normals, places, vertices) else None,
                {name: values[chosen] for name, values in uvs.items()},
                None if colors is None else colors[chosen],
                {name: values[chosen] for name, values in tangents.items()},
                int(slot),
                chosen,
            )
        )
    return found


def placed(part: Part, to_world: np.ndarray, made: Made, name: str) -> Mesh:
    """Make the mesh of a part at `to_world` (4×4). A transform that mirrors turns its triangles over, so that their fronts
    stay outside."""
    linear, offset = to_world[:3, :3], to_world[:3, 3]
    mirrored = np.linalg.det(linear) < 0
    normals = None
    if part.normals is not None:
        cofactors = np.linalg.inv(linear).T if abs(np.linalg.det(linear)) > 1e-30 else linear
        normals = _unit(part.normals.astype(np.float64) @ cofactors.T)
    tangents = part.tangents.get(made.uv_maps[0])
    if tangents is not None:
        sign = tangents[:, 3:] * (-1 if mirrored else 1)
        tangents = np.hstack((_unit(tangents[:, :3] @ linear.T), sign)).astype(np.float32)
    uvs = [part.uvs.get(uv_map) for uv_map in made.uv_maps]
    return Mesh(
        part.positions @ linear.T + offset,
        part.triangles[:, ::-1] if mirrored else part.triangles,
        made.material,
        normals,
        uvs[0],
        uvs[1] if len(uvs) > 1 else None,
        part.colors,
        tangents if normals is not None else None,
        name,
    )


def _array(collection: Any, name: str, count: int, kind: Any = np.float32) -> np.ndarray:
    values = np.empty(count, kind)
    collection.foreach_get(name, values)
    return values


def _uv_maps(mesh: Any, corners: int) -> dict[str, np.ndarray]:
    """Read the UV maps with v downwards, that which renders also as ""."""
    found = {}
    for layer in mesh.uv_layers:
        flat = _array(layer.uv, "vector", corners * 2).reshape(-1, 2)
        found[layer.name] = np.column_stack((flat[:, 0], 1 - flat[:, 1])).astype(np.float32)
        if layer.active_render:
            found[""] = found[layer.name]
    return found


def _colors(mesh: Any, vertices: np.ndarray) -> np.ndarray | None:
    """Read the colour attribute that renders, as linear RGBA of each corner."""
    index = mesh.color_attributes.render_color_index
    if index < 0:
        return None
    attribute = mesh.color_attributes[index]
    flat = _array(attribute.data, "color", len(attribute.data) * 4).reshape(-1, 4)
    return flat[vertices] if attribute.domain == "POINT" else flat


def _tangents(
    mesh: Any, names: tuple[str, ...], corners: int, notices: Notices | None, where: str
) -> dict[str, np.ndarray]:
    found = {}
    for name in names:
        layer = next((x for x in mesh.uv_layers if (x.active_render if name == "" else x.name == name)), None)
        if layer is None:
            continue
        try:
            mesh.calc_tangents(uvmap=layer.name)
        except RuntimeError as reason:
            if notices is not None:
                notices.add(where, f"its tangents follow the texture coordinates only ({reason})")
            continue
        direction = _array(mesh.loops, "tangent", corners * 3).reshape(-1, 3)
        sign = _array(mesh.loops, "bitangent_sign", corners)
        found[name] = np.column_stack((direction, sign)).astype(np.float32)
    return found


def _welded(loops: np.ndarray, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Share vertices between corners with equal rows: the corners that are kept (V,), and triangles (T, 3) of their
    numbers."""
    used, numbers = np.unique(loops, return_inverse=True)
    plain = np.ascontiguousarray(rows[used] + np.float32(0))  # −0 becomes 0, which is the same position.
    keys = plain.view(np.dtype((np.void, plain.dtype.itemsize * plain.shape[1]))).ravel()
    _, first, groups = np.unique(keys, return_index=True, return_inverse=True)
    return used[first], groups.reshape(-1)[numbers.reshape(-1)].reshape(-1, 3).astype(np.int64)


def _is_smooth(loops: np.ndarray, normals: np.ndarray, places: np.ndarray, vertices: np.ndarray) -> bool:
    """Whether any corner's normal differs from that of its triangle."""
    a, b, c = (places[vertices[loops[:, k]]] for k in range(3))
    faces = _unit(np.cross(b - a, c - a))
    return bool((np.einsum("nkc,nc->nk", normals[loops], faces) < 1 - 1e-5).any())


def _unit(vectors: np.ndarray) -> np.ndarray:
    lengths = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors / np.where(lengths > 0, lengths, 1)
