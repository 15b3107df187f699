# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The verb `view`, which shows a solved scene in the browser, and `export_view`, which writes the same as files."""

from __future__ import annotations

import os
import webbrowser
from html import escape
from pathlib import Path
from types import TracebackType
from typing import Self

from eclat.bridge.running import ProgressReport
from eclat.methods import Method, Source
from eclat.methods.records.solution import Solution
from eclat.scene import Scene
from eclat.stage.staging import staged
from eclat.typed import typed
from eclat.viewer.contents import Contents, contents_of
from eclat.viewer.live import Live, with_live
from eclat.viewer.server import Server, require_server

FRAME = (960, 600)
"""Width and height in pixels of the page in a notebook."""


class Viewer:
    """A scene that is shown in the browser, until `close` is called or the program ends.

    In a notebook the value of a cell that ends in `eclat.view(...)` shows itself as a frame. As a context manager it
    closes at the end of the block.
    """

    def __init__(self, contents: Contents, *, whole: bool = False, seed: int = 0, threads: int | None = None) -> None:
        """Start to serve the contents on this machine, and to solve what views lack, and then all surfaces if `whole`."""
        self.contents = contents
        self._closed = False
        self._live = Live(
            contents.scene, contents.solution, contents.gloss, whole=whole, seed=seed, threads=threads or 0
        )
        try:
            self._files = with_live(contents.files())
            self._server = Server(self._files, self._live.routes)
        except BaseException:
            self._live.close()
            raise

    @property
    def solution(self) -> Solution:
        """The records so far, with those that views lacked; `save` keeps them in a file, as for `eclat.solve`."""
        return self._live.growth.solution()

    @property
    def url(self) -> str:
        """The address of the page. It holds a token; whoever knows it, on this machine, can read the scene."""
        return self._server.url

    def wait(self) -> None:
        """Wait until the viewer is closed, or for Ctrl-C."""
        self._server.wait()

    def close(self) -> None:
        """Stop serving the page."""
        self._closed = True
        self._live.close()
        self._server.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def __repr__(self) -> str:
        where = "closed" if self._closed else f"at {self.url}"
        return f"<Viewer of {self.contents.scene.name or 'a scene'}, {where}>"

    def _repr_html_(self) -> str:
        if self._closed:
            return f"<p>{escape(repr(self))}</p>"
        width, height = FRAME
        title = escape(f"Éclat: {self.contents.scene.name or 'scene'}", quote=True)
        return (
            f'<iframe src="{escape(self.url, quote=True)}" title="{title}" width="{width}" height="{height}" '
            'allow="fullscreen" style="border: 0; max-width: 100%"></iframe>'
        )


@typed
def view(
    scene: Scene | str | os.PathLike[str],
    what: Source | type[Method] | str | None = None,
    *,
    whole: bool = False,
    open_browser: bool = False,
    exposure: float = 0.0,
    max_error: float = 0.01,
    texel_size: float | None = None,
    samples: int = 256,
    seed: int = 0,
    threads: int | None = None,
    progress: ProgressReport | None = None,
) -> Viewer:
    """Show a scene in the browser, where one can walk through it: each record of the cache is drawn as a splat.

    Parameters
    ----------
    what : a `Solution` of `eclat.solve`, or a method with records, its class or its name; None means irradiance caching. A
        method is solved while one looks: the page asks for the records that its view lacks, also beside a solution.
    whole : whether all surfaces are solved, too, from when the first page is open. What a page sees comes first.
    open_browser : whether to open the page in the default browser; otherwise open `url`, or end a cell of a notebook
        with this call.
    exposure : the exposure in stops with which the page begins.
    max_error : wanted relative error of the indirect light, if `what` is None, a class or a name.
    texel_size : side in metres of a texel of the light map for the direct light of glowing surfaces and of the sky; None
        chooses it so that the map has about a quarter of a million texels.
    samples : number of samples of these lights per texel.

    Returns
    -------
    The running viewer. It stops when it is closed, or with the program.

    Raises
    ------
    EclatError : starlette or uvicorn is not installed, the page was not built, the scene cannot be loaded, or `what` has
        no records.

    Examples
    --------
    >>> import eclat
    >>> with eclat.view("furnace", texel_size=0.2, samples=16) as viewer:  # doctest: +SKIP
    ...     viewer.wait()
    """
    require_server()
    scene = staged(scene)
    contents = contents_of(
        scene, what, solved=False, exposure=exposure, max_error=max_error,
        soft_light={"texel_size": texel_size, "samples": samples},
        work={"seed": seed, "threads": threads, "progress": progress},
    )  # fmt: skip
    viewer = Viewer(contents, whole=whole, seed=seed, threads=threads)
    if open_browser:
        webbrowser.open(viewer.url)
    return viewer


@typed
def export_view(
    scene: Scene | str | os.PathLike[str],
    folder: str | os.PathLike[str],
    what: Source | type[Method] | str | None = None,
    *,
    exposure: float = 0.0,
    max_error: float = 0.01,
    texel_size: float | None = None,
    samples: int = 256,
    seed: int = 0,
    threads: int | None = None,
    progress: ProgressReport | None = None,
) -> list[Path]:
    """Write what `view` shows as files that any web server can serve, without Python.

    Parameters
    ----------
    folder : where the files are written; it is made if it does not exist. The other parameters are those of `view`.

    Returns
    -------
    The paths of the files; the first page is `index.html`.

    Raises
    ------
    EclatError : as for `view`, or a file cannot be written.
    """
    contents = contents_of(
        staged(scene), what, exposure=exposure, max_error=max_error,
        soft_light={"texel_size": texel_size, "samples": samples},
        work={"seed": seed, "threads": threads, "progress": progress},
    )  # fmt: skip
    return contents.export(Path(folder))
