# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Refractive indices by name: real ones of transparent media, and complex ones of metals in RGB."""

from __future__ import annotations

from eclat.errors import EclatError, did_you_mean, warn
from eclat.loaders.mitsuba.node import Color, Node, Vector
from eclat.loaders.mitsuba.spectra import to_rgb

IOR: dict[str, float] = {
    # The indices are at the wavelength of the sodium line, for gases at 0 °C and 1 atm and for liquids at 20 °C. Any
    # table of optical constants contains them.
    "vacuum": 1.0,
    "helium": 1.000036,
    "hydrogen": 1.000132,
    "air": 1.000277,
    "carbon dioxide": 1.00045,
    "water": 1.3330,
    "acetone": 1.36,
    "ethanol": 1.361,
    "carbon tetrachloride": 1.461,
    "glycerol": 1.4729,
    "benzene": 1.501,
    "silicone oil": 1.52045,
    "bromine": 1.661,
    "water ice": 1.31,
    "fused quartz": 1.458,
    "pyrex": 1.470,
    "acrylic glass": 1.49,
    "polypropylene": 1.49,
    "bk7": 1.5046,
    "sodium chloride": 1.544,
    "amber": 1.55,
    "pet": 1.5750,
    "diamond": 2.419,
}

CONDUCTORS: dict[str, tuple[Vector, Vector]] = {
    # η and k are from E. D. Palik, "Handbook of Optical Constants of Solids", 1998, and from other tables that are
    # collected at refractiveindex.info. They are converted to RGB like the spectrum of a light
    # (`eclat.measure.spectrum.emission_to_rgb`).
    "a-C": ((2.944, 2.227, 1.968), (0.8875, 0.7993, 0.8153)),
    "Ag": ((0.1553, 0.1167, 0.1384), (4.828, 3.122, 2.147)),
    "Al": ((1.658, 0.8804, 0.5212), (9.224, 6.270, 4.837)),
    "Au": ((0.1430, 0.3753, 1.442), (3.983, 2.386, 1.603)),
    "Be": ((4.185, 3.185, 2.784), (3.835, 3.010, 2.869)),
    "Cr": ((4.370, 2.917, 1.655), (5.207, 4.231, 3.755)),
    "Cu": ((0.2010, 0.9237, 1.102), (3.913, 2.453, 2.142)),
    "Cu2O": ((3.552, 2.950, 2.752), (0.1142, 0.1939, 0.6061)),
    "CuO": ((3.248, 2.448, 2.210), (0.5211, 0.5700, 0.7222)),
    "Hg": ((2.399, 1.440, 0.9096), (6.328, 4.372, 3.422)),
    "HgTe": ((4.779, 3.231, 2.660), (1.632, 1.581, 1.729)),
    "Ir": ((3.086, 2.082, 1.618), (5.592, 4.067, 3.267)),
    "K": ((0.06404, 0.04641, 0.03818), (2.104, 1.349, 0.9131)),
    "Li": ((0.2658, 0.1956, 0.2209), (3.540, 2.311, 1.669)),
    "Mo": ((4.484, 3.525, 2.776), (4.111, 3.421, 3.151)),
    "Na": ((0.06027, 0.05614, 0.06199), (3.179, 2.112, 1.579)),
    "Nb": ((3.420, 2.790, 2.396), (3.441, 2.738, 2.580)),
    "Ni": ((2.367, 1.663, 1.467), (4.499, 3.050, 2.345)),
    "Rh": ((2.586, 1.860, 1.554), (6.782, 4.703, 3.976)),
    "Se": ((4.058, 2.843, 2.821), (0.7540, 0.6384, 0.5218)),
    "Ta": ((2.063, 2.393, 2.628), (2.408, 1.741, 1.947)),
    "Te": ((7.390, 4.482, 2.637), (3.256, 3.527, 3.292)),
    "TiC": ((3.701, 2.837, 2.582), (3.266, 2.352, 2.173)),
    "TiN": ((1.648, 1.151, 1.380), (3.368, 1.943, 1.102)),
    "V": ((4.278, 3.513, 2.761), (3.491, 2.889, 3.112)),
    "VC": ((3.658, 2.753, 2.533), (3.068, 2.199, 1.963)),
    "VN": ((2.866, 2.119, 1.940), (3.032, 2.056, 1.616)),
    "W": ((4.371, 3.300, 2.998), (3.501, 2.605, 2.273)),
}


def relative_ior(node: Node, interior: str) -> float:
    """Return the interior refractive index of a BSDF, divided by the exterior one.

    The default of the interior is the medium called `interior`, and the default of the exterior is air.

    Raises
    ------
    EclatError : a medium is unknown, or an index is not above 0.
    """
    if node.get("eta") is not None and node.get("int_ior") is None:
        return node.positive("eta", default=1.0)
    return _ior(node, "int_ior", interior) / _ior(node, "ext_ior", "air")


def conductor_constants(node: Node) -> tuple[Vector, Vector]:
    """Return the refractive index η and the extinction coefficient k of a conductor in RGB, relative to the exterior
    medium.

    They are read from `eta` and `k` or, if these are absent, from the name of a `material`. The material "none" is a
    perfect mirror: η = 0 and k = 1.
    """
    outside = _ior(node, "ext_eta", "air") if node.get("ext_eta") is not None else 1.0
    name = node.string("material", default="Cu" if node.legacy and node.get("eta", "k") is None else "none")
    eta, k = _by_name(name, node)
    eta, k = _constant(node, "eta", eta), _constant(node, "k", k)
    return (eta[0] / outside, eta[1] / outside, eta[2] / outside), (k[0] / outside, k[1] / outside, k[2] / outside)


def _by_name(name: str, node: Node) -> tuple[Vector, Vector]:
    symbol = name.strip().removesuffix("_palik").removesuffix("-e")
    if symbol.lower() == "none":
        return (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)
    known = {key.lower(): key for key in CONDUCTORS}
    if symbol.lower() not in known:
        near = did_you_mean(name, CONDUCTORS)
        warn(f"{node.where}: the conductor {name[:60]!r} is unknown{near}; aluminium (Al) is used instead")
        symbol = "Al"
    return CONDUCTORS[known[symbol.lower()]]


def _constant(node: Node, name: str, default: Vector) -> Vector:
    value = node.get(name)
    if value is None:
        return default
    if isinstance(value, Node):
        raise node.mismatch(name, "a colour, because textures of eta and k are not supported", value)
    if not isinstance(value, Color):
        return (node.number(name, default=0.0),) * 3
    return to_rgb(value, "emission", node.where, legacy=node.legacy)


def _ior(node: Node, name: str, default: str) -> float:
    value = node.get(name)
    if value is None:
        return IOR[default]
    if isinstance(value, str) and value.strip().lower() in IOR:
        return IOR[value.strip().lower()]
    if isinstance(value, str) and not value.strip()[:1].isdigit() and not value.strip().startswith("."):
        near = did_you_mean(value, IOR)
        raise EclatError(f"{node.where}, {name}: expected a number or the name of a medium, got {value[:60]!r}{near}")
    return node.positive(name, default=1.0)
