# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of a scene and of a view layer."""

import bpy

METHODS = (
    ("irradiance-cache", "Irradiance Cache", "Diffuse indirect light is interpolated between records"),
    ("radiance-cache", "Radiance Cache", "Indirect light on glossy surfaces is interpolated, too"),
    ("photon-map", "Photon Map", "Photons from the lamps, which also find caustics"),
    ("radiosity", "Radiosity", "Light between patches, solved once for all views"),
    ("path", "Path Tracing", "Without bias, as the reference for all others"),
    ("direct", "Direct Light", "Light that comes straight from lamps, without indirect light"),
)
"""The methods of Éclat: identifier, label and description."""


class EclatSceneSettings(bpy.types.PropertyGroup):
    """How pictures and light maps are made."""

    method: bpy.props.EnumProperty(name="Method", items=METHODS, default="irradiance-cache")
    max_error: bpy.props.FloatProperty(
        name="Max Error",
        description="Relative error at which rendering stops",
        default=0.03,
        min=0.001,
        max=1,
        precision=3,
    )
    use_time: bpy.props.BoolProperty(
        name="Limit Time", description="Choose the quality so that the picture is done in time", default=False
    )
    time: bpy.props.FloatProperty(name="Time", subtype="TIME_ABSOLUTE", unit="TIME_ABSOLUTE", default=60, min=1)
    samples: bpy.props.IntProperty(
        name="Samples", description="Paths per pixel; 0 takes as many as Max Error needs", default=0, min=0, max=65536
    )
    denoise: bpy.props.BoolProperty(
        name="Denoise",
        description="Remove the noise with Open Image Denoise, where that lowers the error",
        default=True,
    )
    seed: bpy.props.IntProperty(name="Seed", default=0, min=0)
    bake_size: bpy.props.IntProperty(
        name="Size", description="Width and height of light maps in texels", default=512, min=16, max=8192
    )
    bake_margin: bpy.props.IntProperty(
        name="Margin", description="Texels around each island that take the colour beside it", default=4, min=0, max=64
    )
    bake_samples: bpy.props.IntProperty(
        name="Light Samples", description="Samples of the lamps for each texel", default=256, min=1, max=65536
    )
    bake_component: bpy.props.EnumProperty(
        name="Light",
        items=(
            ("total", "All", "Direct and indirect light"),
            ("direct", "Direct", "Light that comes straight from lamps"),
            ("indirect", "Indirect", "Light that surfaces reflect or transmit"),
        ),
        default="total",
    )


class EclatLayerSettings(bpy.types.PropertyGroup):
    """The passes of a view layer, beside Depth and Normal, which Blender switches itself."""

    use_direct: bpy.props.BoolProperty(name="Direct", description="Light that comes straight from lamps")
    use_indirect: bpy.props.BoolProperty(name="Indirect", description="Light that surfaces reflect or transmit")
    use_albedo: bpy.props.BoolProperty(name="Albedo", description="Share of light that surfaces reflect")
    use_record_density: bpy.props.BoolProperty(name="Record Density", description="Number of records in each pixel")
