# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Warnings about settings of a Mitsuba file that would change the converged picture but are not supported."""

from __future__ import annotations

from eclat.errors import warn
from eclat.loaders.mitsuba.kinds import PLUGINS
from eclat.loaders.mitsuba.node import Node

_PATHS = ("path", "volpath", "volpathmis", "volpath_simple", "bdpt", "mlt", "pssmlt", "erpt", "ptracer", "vpl", "prb")
"""Integrators whose converged picture is that of all light."""

_WRAPPERS = ("adaptive", "irrcache", "aov", "moment", "multichannel")
"""Integrators that hold another one."""


def tell_of_settings(tree: Node) -> None:
    """Warn once about each setting of integrators and films that would change a converged picture but is not used.

    No converged picture depends on how samples are drawn, on their number, or on where roulette begins (`rr_depth`).
    """
    for _, node in tree.children:
        if node.tag == "integrator":
            _tell_of_integrator(node)
        elif node.tag == "sensor":
            for _, film in node.of_tag("film"):
                _tell_of_filter(film)


def _tell_of_integrator(node: Node) -> None:
    if node.type in _WRAPPERS:
        for _, inner in node.of_tag("integrator"):
            _tell_of_integrator(inner)
        return
    if node.type not in PLUGINS["integrator"]:
        return  # it was named as unknown
    if node.boolean("hide_emitters", default=False):
        warn(f"{node.where}: hide_emitters is not supported; the camera sees lamps and sky")
    if node.type == "direct":
        warn(
            f"{node.where}: this integrator is not read from files; pictures have indirect light as well, "
            "unless you ask for max_depth 2 or the method direct"
        )
    elif node.type in _PATHS:
        depth = node.integer("max_depth", default=-1)
        if depth >= 0:
            warn(f"{node.where}: max_depth {depth} is not read from files; all light is computed unless you ask for it")
    else:
        warn(f"{node.where}: this integrator is not read from files; pictures show all light")


def _tell_of_filter(film: Node) -> None:
    for _, node in film.of_tag("rfilter"):
        if node.type not in ("box", "tent"):
            warn(
                f"{node.where}: a filter of this type is not supported; pixels are squares (`--filter tent` is smoother)"
            )
        elif node.type == "tent":
            warn(
                f"{node.where}: the filter is not read from files; pixels are squares unless you ask for `--filter tent`"
            )
