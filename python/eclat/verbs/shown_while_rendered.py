# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Pictures that a display server shows while they are rendered."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from eclat.errors import EclatError, shown
from eclat.images.image import Image
from eclat.methods import IrradianceCache, as_method
from eclat.stage.staging import staged
from eclat.tev.display import Display

Preview = Callable[[Image], None]


def shown_while_rendered(render: Callable[..., Image], arguments: dict[str, Any]) -> Image:
    """Render a picture that the `display_server` (str) of the arguments shows, named after its scene and its method.

    Parameters
    ----------
    render : the verb.
    arguments : its arguments by name.

    Raises
    ------
    EclatError : `display_server` is no address; `render` raises it too.
    """
    scene = staged(arguments["scene"])
    method = as_method(arguments["what"], IrradianceCache()).options.name
    with Display(arguments["display_server"], f"{scene.name} ({method})") as display:
        return render(**arguments | {"scene": scene, "display_server": display})


def with_display(preview: Preview | None, display: Display | None) -> Preview | None:
    """Make the function that passes unfinished pictures to both, of which each may be None.

    Raises EclatError if `display` is of another type.
    """
    if not isinstance(display, Display | None):
        raise EclatError(f'display_server: expected "host:port", an eclat.Display or None, got {shown(display)}')
    if display is None or preview is None:
        return preview if display is None else display.show

    def both(image: Image) -> None:
        display.show(image)
        preview(image)

    return both
