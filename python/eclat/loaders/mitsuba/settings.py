# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Warn about settings of a Mitsuba file that would change the converged image but are not supported."""

from __future__ import annotations

from eclat.errors import warn
from eclat.loaders.mitsuba.kinds import PLUGINS
from eclat.loaders.mitsuba.node import Node

_PATHS = ("path", "volpath", "volpathmis", "volpath_simple", "bdpt", "mlt", "pssmlt", "erpt", "ptracer", "vpl", "prb")
"""The integrators that compute all light, if they are not limited by `max_depth`."""

_WRAPPERS = ("adaptive", "irrcache", "aov", "moment", "multichannel")
"""The integrators that contain another integrator."""


def hides_emitters(tree: Node) -> bool:
    """Return whether an integrator hides lamps from the camera."""
    integrators = [node for _, node in tree.of_tag("integrator")]
    while integrators:
        node = integrators.pop()
        if node.boolean("hide_emitters", default=False):
            return True
        integrators += [inner for _, inner in node.of_tag("integrator")]
    return False


def warn_about_settings(tree: Node, sky: bool) -> None:
    """Warn about each setting of an integrator or a film that would change the converged image but is not used. `sky`
    tells whether the scene has an environment.

    There is no warning about the sampler, the number of samples and the start of Russian roulette (`rr_depth`),
    because the converged image does not depend on them.
    """
    if sky and hides_emitters(tree):
        warn(f"{tree.where}: hide_emitters hides lamps, but not the sky: it is visible to the camera")
    for _, node in tree.children:
        if node.tag == "integrator":
            _warn_about_integrator(node)
        elif node.tag == "sensor":
            for _, film in node.of_tag("film"):
                _warn_about_filter(film)


def _warn_about_integrator(node: Node) -> None:
    if node.type in _WRAPPERS:
        for _, inner in node.of_tag("integrator"):
            _warn_about_integrator(inner)
        return
    known = node.type in PLUGINS["integrator"]
    if node.type == "direct":
        warn(
            f"{node.where}: the integrator is not read from scene files; images include indirect light, "
            "unless you choose the method direct or set max_depth to 2"
        )
    elif node.type in _PATHS or not known:  # another warning says that a type is unknown
        depth = node.integer("max_depth", default=-1)
        if depth >= 0:
            warn(
                f"{node.where}: max_depth is not read from scene files; paths of all lengths are computed, unless you "
                f"set max_depth to {depth} when you render"
            )
    else:
        warn(f"{node.where}: the integrator is not read from scene files; images include all light")


def _warn_about_filter(film: Node) -> None:
    named = [node for _, node in film.of_tag("rfilter")]
    if not named:
        warn(
            f"{film.where}: a film without an rfilter has a gaussian one in Mitsuba; a box filter is used (choose "
            "`--filter tent` for smoother edges)"
        )
    for node in named:
        if node.type not in ("box", "tent"):
            warn(
                f"{node.where}: the reconstruction filter {node.type!r} is not supported; a box filter is used "
                "(choose `--filter tent` for smoother edges)"
            )
        elif node.type == "tent":
            warn(
                f"{node.where}: the reconstruction filter is not read from scene files; a box filter is used, unless "
                "you choose `--filter tent`"
            )
