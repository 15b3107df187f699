# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The tables of glossy lobes that radiance caching needs for the materials of a scene, which are read from disk or
computed once."""

from __future__ import annotations

import weakref

from eclat import _core
from eclat.brdf_table import Kind, brdf_table
from eclat.bridge.compiled import compiled
from eclat.bridge.running import ProgressReport
from eclat.methods.records.options import RadianceOptions
from eclat.scene import Scene

_KINDS: dict[_core.TableLobeKind, Kind] = {
    _core.TableLobeKind.phong: "phong",
    _core.TableLobeKind.ward: "ward",
    _core.TableLobeKind.ggx: "ggx",
    _core.TableLobeKind.beckmann: "beckmann",
}

_cache: weakref.WeakKeyDictionary[Scene, dict[tuple[int, float], _core.RadianceTables]] = weakref.WeakKeyDictionary()


def radiance_tables(
    scene: Scene, options: RadianceOptions, *, threads: int | None = None, progress: ProgressReport | None = None
) -> _core.RadianceTables:
    """Return the tables for all metallic-roughness lobes, and for the other lobes whose parameters do not vary over
    surfaces.

    Lobes without a table are traced. The tables are kept as long as the scene exists.
    """
    known = _cache.setdefault(scene, {})
    key = options.order, options.gloss_error
    if key not in known:
        core = compiled(scene).core
        lobes, roughness = _core.wanted_radiance_tables(core)
        tables = []
        for kind, u, v, correlated in lobes:
            lobe: dict[str, object] = {"exponent": u} if _KINDS[kind] == "phong" else {"alpha": (u, v)}
            if correlated:
                lobe["masking"] = "correlated"
            tables.append(_table(_KINDS[kind], options, lobe, threads, progress))
        if roughness:
            tables.append(_table("metallic-roughness", options, {}, threads, progress))
        known[key] = _core.RadianceTables(core, tables, options.order)
    return known[key]


def _table(
    kind: Kind, options: RadianceOptions, lobe: dict[str, object], threads: int | None, progress: ProgressReport | None
) -> _core.BrdfTable:
    return brdf_table(
        kind, basis="spherical", order=options.order, max_error=options.gloss_error, threads=threads, progress=progress,
        **lobe,  # type: ignore[arg-type]
    ).core  # fmt: skip
