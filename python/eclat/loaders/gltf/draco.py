# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Decompress the geometry of primitives that Draco compressed [KHR_draco_mesh_compression].

The decoder is that of the package `DracoPy` (the extra `files`).
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError
from eclat.loaders.budget import spend
from eclat.loaders.gltf.accessors import WIDTHS, Accessors, component_type
from eclat.loaders.gltf.element import Element
from eclat.loaders.optional import optional_module

Numbers = NDArray[Any]
_NAME = "KHR_draco_mesh_compression"
_TRIANGLES = 4


def decompressed(element: Element, attributes: Element, accessors: Accessors) -> tuple[Element, Accessors]:
    """Return a primitive and its accessors so that they can be read as if the geometry were not compressed.

    Parameters
    ----------
    element : the primitive. If Draco does not compress it, or the file also has the uncompressed data, it is returned
        as it is.
    attributes : its attributes.
    accessors : the accessors of the file.

    Returns
    -------
    The primitive as a list of triangles, and accessors that give the decompressed arrays.

    Raises
    ------
    EclatError : the compressed data are invalid or do not fit the accessors, or the decoder is not installed.
    """
    packed = element.extension(_NAME)
    if packed is None or accessors.has_data(attributes, "POSITION"):
        return element, accessors
    if element.where not in accessors.overlays:
        accessors.overlays[element.where] = _arrays(element, attributes, packed, accessors)
    triangles = replace(element, data={**element.data, "mode": _TRIANGLES})
    return triangles, accessors.overlaid(accessors.overlays[element.where])


def _arrays(element: Element, attributes: Element, packed: Element, accessors: Accessors) -> dict[int, Numbers]:
    """Decode a primitive: its arrays by the indices of their accessors."""
    decoder = optional_module("DracoPy", "files", f"{element.where}: geometry compressed by Draco")
    view = accessors.document.buffer_view(packed)
    if view is None:
        raise EclatError(f"{packed.where}: expected the index of a buffer view as 'bufferView', but it is missing")
    corners, points = accessors.count(element, "indices"), accessors.count(attributes, "POSITION")
    spend(12 * points + 4 * corners, element.where)
    try:
        mesh = decoder.decode(bytes(view[0]))
        found = {attribute["unique_id"]: np.asarray(attribute["data"]) for attribute in mesh.attributes}
        faces = np.asarray(getattr(mesh, "faces", np.zeros((0, 3), np.uint32)))
    # The package raises its own exceptions, which have no common base, and those of NumPy and of Draco.
    except Exception as error:
        raise EclatError(
            f"{packed.where}: the geometry cannot be decompressed: {error or type(error).__name__}"
        ) from None
    arrays: dict[int, Numbers] = {}
    names = packed.child("attributes")
    for name in [] if names is None else names.data:
        if name not in attributes.data:
            raise EclatError(f"{packed.where}: expected attributes of the primitive, got {name[:40]!r} as well")
        values = found.get(names.integer(name)) if names is not None else None
        if values is None:
            raise EclatError(f"{packed.where}: expected {name[:40]!r} in the compressed data, but it is missing")
        _keep(arrays, values, attributes, name, accessors)
    if "indices" in element.data:
        _keep(arrays, faces.reshape(-1, 1), element, "indices", accessors)
    return arrays


def _keep(arrays: dict[int, Numbers], values: Numbers, owner: Element, member: str, accessors: Accessors) -> None:
    """Add the array of the accessor whose index is the member `member` of `owner`. Raises EclatError if it does not fit."""
    known = accessors.document.elements("accessors")
    index = owner.index(member, len(known), "accessors")
    assert index is not None, "the caller has checked that the member exists"
    accessor, dtype = known[index], component_type(known[index])
    width = WIDTHS.get(accessor.text("type"), 0)
    with np.errstate(all="ignore"):
        converted = values.astype(dtype)
    if converted.shape != (accessor.integer("count"), width):
        raise EclatError(
            f"{accessor.where}: expected {accessor.integer('count')} × {width} values of {member} in the data compressed by "
            f"Draco, got {' × '.join(map(str, converted.shape))}"
        )
    if values.dtype != dtype and not np.array_equal(converted, values):
        raise EclatError(f"{accessor.where}: expected values that fit {dtype} for {member}, got {values.dtype}")
    arrays[index] = converted
