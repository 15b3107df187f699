# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Load shapes from files: obj, ply, serialized and, as an extension of Éclat, gltf.

A shape of type obj or gltf without a BSDF has the materials of its file. A BSDF in such a shape that has the name of
a material in the file replaces that material.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from eclat.errors import EclatError, did_you_mean, warn
from eclat.loaders.mitsuba.materials import Materials, default_material
from eclat.loaders.mitsuba.node import Node
from eclat.loaders.obj import load_obj
from eclat.loaders.ply import load_ply
from eclat.loaders.serialized import load_serialized
from eclat.scene import Material, Mesh

MESH_FILES = ("obj", "ply", "serialized", "gltf")

_OWN = ("bsdf", "ref")
"""The names under which a BSDF applies to the whole shape and does not replace a material of the file."""


def load_mesh_file(node: Node, materials: Materials) -> list[Mesh]:
    """Load the meshes of a shape's file, with materials, in the coordinates of the file.

    Raises
    ------
    EclatError : the file does not exist or is invalid.
    """
    own = [child for name, child in node.of_tag("bsdf") if name in _OWN or not (name or child.id)]
    named = {name or child.id: child for name, child in node.of_tag("bsdf") if child not in own}
    if node.type in ("ply", "serialized"):
        own, named = [*own, *named.values()], {}
    if len(own) > 1:
        warn(f"{node.where}: expected one BSDF, got {len(own)}; the first one is used")
    if named:
        return _with_replacements(node, materials, own, named)
    if own or node.type in ("ply", "serialized"):
        return _with_bsdf(node, materials, own)
    meshes = _with_file_materials(node)
    if _is_emissive(node):
        # An emissive shape without a BSDF is black, as in Mitsuba. Materials of the mesh file are kept.
        black = default_material(emissive=True)
        meshes = [mesh if mesh.material.name else replace(mesh, material=black) for mesh in meshes]
    return meshes


def _with_bsdf(node: Node, materials: Materials, own: list[Node]) -> list[Mesh]:
    material = materials.of(own[0]) if own else default_material(emissive=_is_emissive(node))
    return [replace(mesh, material=material) for mesh in _bare(node)]


def _is_emissive(node: Node) -> bool:
    return bool(list(node.of_tag("emitter")))


def _with_replacements(node: Node, materials: Materials, own: list[Node], named: dict[str, Node]) -> list[Mesh]:
    meshes = _with_file_materials(node)
    known = {mesh.material.name for mesh in meshes if mesh.material.name}
    unknown = [name for name in named if name not in known]
    if len(unknown) == 1 and len(named) == 1 and not own:
        # In Mitsuba, the name of a BSDF has no meaning. A single BSDF therefore applies to the whole shape.
        if known and unknown[0] != named[unknown[0]].id:
            near = did_you_mean(unknown[0], known)
            warn(
                f"{node.where}: the file has no material called {unknown[0]!r}{near}; the BSDF is used for the whole "
                "shape"
            )
        return _with_bsdf(node, materials, [named[unknown[0]]])
    for name in unknown:
        warn(
            f"{node.where}: the BSDF {name!r} is ignored, because the file has no material of this name"
            f"{did_you_mean(name, known)}"
        )
    made: dict[str, Material] = {}
    result = []
    for mesh in meshes:
        name = mesh.material.name
        replacement = named.get(name, own[0] if own else None)
        if replacement is not None and name not in made:
            material = materials.of(replacement)
            made[name] = material if material.name else replace(material, name=name)
        result.append(mesh if replacement is None else replace(mesh, material=made[name]))
    return result


def _with_file_materials(node: Node) -> list[Mesh]:
    face_normals = node.boolean("face_normals", default=False)
    if node.type == "obj":
        flip = node.boolean("flip_tex_coords", default=True)
        return load_obj(_path(node), face_normals=face_normals, flip_v=flip)
    from eclat.loaders.gltf import load_gltf  # imported here because it is large and seldom needed

    scene = load_gltf(_path(node))
    if scene.lights or scene.environment:
        warn(f"{node.where}: the lights of the glTF file are ignored, and only its meshes are used")
    if face_normals:
        return [replace(mesh, normals=None) for mesh in scene.meshes]
    return list(scene.meshes)


def _path(node: Node) -> Path:
    path = node.file("filename")
    if not path.exists():
        raise EclatError(f"{node.where}, filename: expected a mesh file, but {path} does not exist")
    return path


def _bare(node: Node) -> list[Mesh]:
    """Load the meshes without the materials of the file. As in Mitsuba, normals are computed if the file has none."""
    path = _path(node)
    face_normals = node.boolean("face_normals", default=False)
    if node.type == "obj":
        flip = node.boolean("flip_tex_coords", default=True)
        return load_obj(path, face_normals=face_normals, materials=False, smooth=True, flip_v=flip)
    if node.type == "gltf":
        return _with_file_materials(node)
    if node.type == "ply":
        mesh = load_ply(path, face_normals=face_normals)
    else:
        mesh = load_serialized(path, node.integer("shape_index", default=0), face_normals=face_normals)
    if mesh.uvs is not None and node.boolean("flip_tex_coords", default=False):
        mesh = replace(mesh, uvs=mesh.uvs * np.array([1, -1], dtype=np.float32) + np.array([0, 1], dtype=np.float32))
    return [mesh]
