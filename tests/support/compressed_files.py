# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What the files of `tests/support/compressed` were made from, by encoders that are not those that Éclat decodes with.

    python tests/support/compressed_files.py FOLDER         # writes plain.glb, opaque.png and alpha.png
    npx @gltf-transform/cli draco plain.glb draco.glb       # version 4.5.1, as for the other two
    npx @gltf-transform/cli meshopt plain.glb meshopt.glb
    npx @gltf-transform/cli quantize plain.glb quantized.glb
    python -c 'import alktx2; …'                            # version 0.1.7; quality=90, effort=5, mipmaps=True

`encode_image_to_ktx2` of the last made etc1s.ktx2 of opaque.png with the codec "etc1s", uastc.ktx2 of opaque.png with "uastc"
and zstd, and uastc_alpha.ktx2 of alpha.png with "uastc".
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).parent.parent))

from support.gltf_files import GltfFile

COMPRESSED = Path(__file__).parent / "compressed"
COLUMNS, ROWS = 24, 12


def picture(alpha: bool = False) -> NDArray[np.uint8]:
    """A smooth image (32, 48, 3 or 4); no two of its rows or columns are equal."""
    y, x = np.mgrid[0:32, 0:48]
    channels = [128 + 90 * np.sin(x / 16), 128 + 90 * np.cos(y / 16), 60 + 2 * x - y, 10 + 4 * x + y]
    return np.stack(channels[: 4 if alpha else 3], axis=-1).clip(0, 255).astype(np.uint8)


def ball() -> GltfFile:
    """A textured, coloured ball of radius 2 around (1, 1, 1), moved by (1, 2, 3); a morph target at 0.5 raises its top."""
    u, v = np.meshgrid(np.arange(COLUMNS + 1) / COLUMNS, np.arange(ROWS + 1) / ROWS)
    phi, theta = 2 * np.pi * u, np.pi * v
    unit = np.stack([np.cos(phi) * np.sin(theta), np.cos(theta), np.sin(phi) * np.sin(theta)], axis=-1).reshape(-1, 3)
    column, row = np.meshgrid(np.arange(COLUMNS), np.arange(ROWS))
    a = (row * (COLUMNS + 1) + column).ravel()
    b, c, d = a + 1, a + COLUMNS + 1, a + COLUMNS + 2
    triangles = np.concatenate([np.stack([a, b, c], axis=-1)[COLUMNS:], np.stack([b, d, c], axis=-1)[:-COLUMNS]])
    file = GltfFile()
    material = file.append(
        "materials", {"pbrMetallicRoughness": {"baseColorTexture": {"index": file.texture(picture())}}}
    )
    primitive: dict[str, Any] = file.primitive(2 * unit + 1, triangles.ravel(), material=material)
    primitive["attributes"] |= {
        "NORMAL": file.accessor(unit),
        "TEXCOORD_0": file.accessor(np.stack([u, v], axis=-1).reshape(-1, 2)),
        "COLOR_0": file.accessor(np.column_stack([0.5 + 0.4 * unit, np.ones(len(unit))])),
    }
    raised = np.zeros_like(unit)
    raised[:, 1] = np.maximum(unit[:, 1], 0)
    primitive["targets"] = [{"POSITION": file.accessor(raised)}]
    node = file.mesh_node(primitive, name="ball", translation=[1, 2, 3], weights=[0.5])
    file.json["scenes"], file.json["scene"] = [{"nodes": [node]}], 0
    return file


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    ball().save(folder, "plain.glb")
    for name, alpha in (("opaque.png", False), ("alpha.png", True)):
        Image.fromarray(picture(alpha)).save(folder / name)
