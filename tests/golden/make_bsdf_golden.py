# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Writes bsdf_mitsuba.csv: values and densities of BSDFs by Mitsuba 3, which `tests/core/bsdf/test_bsdf_golden.cpp` expects.

Run as `python tests/golden/make_bsdf_golden.py`. The names of the models are those of the C++ test, which holds the
same parameters. Directions follow our convention: wo towards the viewer (Mitsuba's si.wi), wi towards the light.
"""

from __future__ import annotations

import itertools
from pathlib import Path

import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")

TARGET = Path(__file__).with_name("bsdf_mitsuba.csv")
RED = {"type": "rgb", "value": [0.8, 0.4, 0.2]}
GREEN = {"type": "rgb", "value": [0.3, 0.9, 0.5]}
GOLD = {
    "eta": {"type": "rgb", "value": [0.143, 0.375, 1.442]},
    "k": {"type": "rgb", "value": [3.983, 2.386, 1.603]},
}

ROUGH = {
    "diffuse": {"type": "diffuse", "reflectance": RED},
    "conductor_ggx": {"type": "roughconductor", "distribution": "ggx", "alpha": 0.3, **GOLD},
    "conductor_ggx_anisotropic": {
        "type": "roughconductor",
        "distribution": "ggx",
        "alpha_u": 0.1,
        "alpha_v": 0.5,
        "specular_reflectance": RED,
        **GOLD,
    },
    "conductor_beckmann": {"type": "roughconductor", "distribution": "beckmann", "alpha": 0.3, **GOLD},
    "conductor_beckmann_anisotropic": {
        "type": "roughconductor",
        "distribution": "beckmann",
        "alpha_u": 0.6,
        "alpha_v": 0.2,
        **GOLD,
    },
    "dielectric_ggx": {
        "type": "roughdielectric",
        "distribution": "ggx",
        "alpha": 0.3,
        "int_ior": 1.5,
        "ext_ior": 1.0,
    },
    "dielectric_ggx_anisotropic": {
        "type": "roughdielectric",
        "distribution": "ggx",
        "alpha_u": 0.2,
        "alpha_v": 0.5,
        "int_ior": 1.33,
        "ext_ior": 1.0,
        "specular_reflectance": RED,
        "specular_transmittance": GREEN,
    },
    "dielectric_beckmann": {
        "type": "roughdielectric",
        "distribution": "beckmann",
        "alpha": 0.4,
        "int_ior": 1.8,
        "ext_ior": 1.0,
    },
    "plastic": {"type": "plastic", "diffuse_reflectance": RED, "int_ior": 1.49, "ext_ior": 1.0},
    "plastic_nonlinear": {
        "type": "plastic",
        "diffuse_reflectance": RED,
        "int_ior": 1.49,
        "ext_ior": 1.0,
        "nonlinear": True,
    },
    "roughplastic_ggx": {
        "type": "roughplastic",
        "distribution": "ggx",
        "alpha": 0.3,
        "int_ior": 1.49,
        "ext_ior": 1.0,
        "diffuse_reflectance": RED,
        "specular_reflectance": GREEN,
    },
    "roughplastic_beckmann_nonlinear": {
        "type": "roughplastic",
        "distribution": "beckmann",
        "alpha": 0.15,
        "int_ior": 1.6,
        "ext_ior": 1.0,
        "diffuse_reflectance": RED,
        "nonlinear": True,
    },
}

SMOOTH = {
    "conductor": {"type": "conductor", **GOLD},
    "dielectric": {
        "type": "dielectric",
        "int_ior": 1.5,
        "ext_ior": 1.0,
        "specular_reflectance": RED,
        "specular_transmittance": GREEN,
    },
    "thin_dielectric": {
        "type": "thindielectric",
        "int_ior": 1.5,
        "ext_ior": 1.0,
        "specular_reflectance": RED,
        "specular_transmittance": GREEN,
    },
    "plastic": {"type": "plastic", "diffuse_reflectance": RED, "int_ior": 1.49, "ext_ior": 1.0},
}


def direction(theta: float, phi: float) -> np.ndarray:
    """Unit vector at polar angle `theta` and azimuth `phi`, degrees."""
    t, p = np.radians([theta, phi])
    return np.array([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)])


def interaction(wo: np.ndarray) -> mi.SurfaceInteraction3f:
    """A surface seen from `wo`, in its own frame."""
    si = mi.SurfaceInteraction3f()
    si.wi = mi.Vector3f(*wo)
    si.n = mi.Normal3f(0, 0, 1)
    si.sh_frame = mi.Frame3f(si.n)
    return si


def value_rows(name: str, bsdf: mi.BSDF) -> list[str]:
    """f·|cos| and pdf for pairs on all sides; only those that differ from zero, and a few that do not."""
    context, rows = mi.BSDFContext(), []
    outgoing = [direction(t, p) for t, p in ((5, 20), (40, 70), (75, 200), (88, 10), (150, 30), (115, 300))]
    incoming = [
        direction(t, p) for t, p in ((10, 50), (35, 250), (50, 190), (80, 20), (160, 240), (125, 130), (100, 200))
    ]
    zeros = 0
    for wo, wi in itertools.product(outgoing, incoming):
        f = np.array(bsdf.eval(context, interaction(wo), mi.Vector3f(*wi))).ravel()
        pdf = float(bsdf.pdf(context, interaction(wo), mi.Vector3f(*wi)))
        zeros += not f.any()
        if f.any() or zeros <= 3:
            rows.append(row("value", name, wo, wi, f, pdf))
    return rows


def delta_rows(name: str, bsdf: mi.BSDF) -> list[str]:
    """Directions and weight × probability of each delta part."""
    context, rows = mi.BSDFContext(), []
    for theta, side in itertools.product((0, 20, 50, 85), (0, 1)):
        wo = direction(180 - theta if side else theta, 35)
        for part in (0.0, 0.9999):
            sample, weight = bsdf.sample(context, interaction(wo), part, mi.Point2f(0.5, 0.5))
            if mi.has_flag(mi.BSDFFlags(sample.sampled_type), mi.BSDFFlags.Delta) and sample.pdf > 0:
                f = np.array(weight).ravel() * sample.pdf
                rows.append(row("delta", name, wo, np.array(sample.wo).ravel(), f, float(sample.pdf)))
    return list(dict.fromkeys(rows))


def row(kind: str, name: str, wo: np.ndarray, wi: np.ndarray, f: np.ndarray, pdf: float) -> str:
    return ",".join([kind, name, *(f"{x:.7g}" for x in (*wo, *wi, *f, pdf))])


def main() -> None:
    rows = []
    for name, parameters in ROUGH.items():
        rows += value_rows(name, mi.load_dict(parameters))
    for name, parameters in SMOOTH.items():
        rows += delta_rows(name, mi.load_dict(parameters))
    header = [
        f"# Mitsuba {mi.__version__}, scalar_rgb; by tests/golden/make_bsdf_golden.py, which holds the parameters.",
        "# value: f·|cos θ_i| and pdf of a pair of directions; delta: weight·probability and probability of a sample.",
        "kind,model,wo_x,wo_y,wo_z,wi_x,wi_y,wi_z,r,g,b,pdf",
    ]
    TARGET.write_text("\n".join(header + rows) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
