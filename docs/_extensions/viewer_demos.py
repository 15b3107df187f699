# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A page of the site with scenes that one can walk through: the static files that `eclat view --export` writes, in frames.

The page `demo/index.md` is written at each build. The scenes are solved when the site is finished, unless those in the folder
were made by the same version of Éclat and of the page; `-D viewer_demos=0` leaves them out.
"""

from __future__ import annotations

import hashlib
from dataclasses import replace
from functools import reduce
from pathlib import Path

import numpy as np
from sphinx.application import Sphinx

import eclat
from eclat.scene import Camera
from eclat.viewer.page import page_files
from project_pages import write_if_changed

DEMOS = {
    "cornell-box": "The Cornell box, solved for all surfaces",
    "atrium": "The atrium under a sun and a sky, solved for five views on a way into it",
}
"""Maps built-in scenes to their headings."""

MAX_ERROR = {"cornell-box": 0.01, "atrium": 0.03}
"""Wanted errors of their records. More rays make the Cornell box smooth for few more bytes."""

VIEWS = {"atrium": ((0.0, 0.0), (0.0, 25.0), (2.0, 0.0), (4.0, 15.0), (4.0, -20.0))}
"""Views for which scenes are solved: how many metres the first camera goes ahead, and by how many degrees it turns left. Records
for all surfaces of the atrium would take 170 MB, because its columns are turned and its balusters are many."""

SIZE = (256, 144)
"""Width and height in pixels of these views."""

HEAD = """# A walk through solved scenes

These scenes were solved once, by irradiance caching, and written as `eclat view SCENE --export` does. Your graphics card draws
each record as a splat over what it serves; [the guide to the viewer](../guides/view.md) says how. Drag to turn, scroll to go
nearer; with the picture focused, W A S D or the arrows walk. Try the overlays, and click to inspect a record.

Browsers load these frames from a web server only. For a copy of the site on your disc, run `python -m http.server` in its folder.
"""

FRAME = """
## {title}

```{{raw}} html
<iframe src="{name}/index.html" title="{title}" width="100%" height="560" loading="lazy" allow="fullscreen"></iframe>
```
"""

ABSENT = """
This build of the site has no scenes; `make docs` makes them.
"""

MADE_FROM = "made-from.txt"
"""The name of the file beside a scene that says what it was made from."""


def write_page(app: Sphinx) -> None:
    """Write the page, with a frame for each scene if scenes are made."""
    frames = (FRAME.format(name=name, title=title) for name, title in DEMOS.items())
    text = HEAD + ("".join(frames) if app.config.viewer_demos else ABSENT)
    write_if_changed(Path(app.srcdir) / "demo" / "index.md", text)


def moved(camera: Camera, ahead: float, degrees: float) -> Camera:
    """Return the camera that went ahead by metres and turned left by degrees."""
    matrix = np.array(camera.to_world, np.float64)
    axes = matrix[:3, :3] / np.linalg.norm(matrix[:3, :3], axis=0)
    cosine, sine = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    matrix[:3, 3] -= ahead * axes[:, 2]
    matrix[:3, :3] = matrix[:3, :3] @ np.array([[cosine, 0, sine], [0, 1, 0], [-sine, 0, cosine]])
    return replace(camera, to_world=matrix)


def export(name: str, folder: Path) -> None:
    """Solve a scene for its views, or for all surfaces, and write its files."""
    scene, method = eclat.load(name), eclat.IrradianceCache(max_error=MAX_ERROR[name])
    if name not in VIEWS:
        eclat.export_view(scene, folder, method)
        return
    cameras = [moved(scene.cameras[0], *view) for view in VIEWS[name]]
    solved = [eclat.solve(scene, method, camera=camera, size=SIZE, check=False) for camera in cameras]
    eclat.export_view(scene, folder, reduce(eclat.merge, solved))


def write_scenes(app: Sphinx, exception: Exception | None) -> None:
    """Solve and write the scenes."""
    if exception is not None or app.builder.name != "html" or not app.config.viewer_demos:
        return
    page = hashlib.sha256(b"".join(page_files().values())).hexdigest()
    for name in DEMOS:
        folder = Path(app.outdir) / "demo" / name
        made_from = f"{eclat.__version__} {MAX_ERROR[name]} {VIEWS.get(name)} {page}\n"
        mark = folder / MADE_FROM
        # Sphinx removes pages that it did not make itself when it builds the site again.
        whole = mark.exists() and (folder / "index.html").exists()
        if whole and mark.read_text() == made_from:
            continue
        export(name, folder)
        mark.write_text(made_from)


def setup(app: Sphinx) -> dict[str, bool]:
    app.add_config_value("viewer_demos", True, "html", bool)
    app.connect("builder-inited", write_page)
    app.connect("build-finished", write_scenes)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
