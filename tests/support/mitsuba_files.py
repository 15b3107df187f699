# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A Mitsuba scene in which most of what the format has occurs once."""

from __future__ import annotations

WHOLE = """<?xml version="1.0"?>
<scene version="3.0.0">
    <default name="angle" value="40"/><default name="angles" value="50"/>
    <sensor type="perspective"><float name="fov" value="$angles"/>
        <transform name="to_world"><lookat origin="0, 0, 5" target="0, 0, 0" up="0, 1, 0"/></transform>
        <film type="hdrfilm"><integer name="width" value="8"/><integer name="height" value="8"/>
          <rfilter type="box"/></film>
    </sensor>
    <texture type="checkerboard" id="board"><rgb name="color0" value="#ff8000"/></texture>
    <bsdf type="twosided" id="white"><bsdf type="roughplastic"><ref name="diffuse_reflectance" id="board"/>
        <float name="alpha" value=".2"/></bsdf></bsdf>
    <alias id="white" as="snow"/>
    <shape type="shapegroup" id="group"><shape type="cube"><ref id="snow"/></shape></shape>
    <shape type="instance"><ref id="group"/><transform name="to_world"><rotate y="1" angle="$angle"/>
        <scale value="0.5"/><translate x="1" y="2"/></transform></shape>
    <shape type="rectangle"><boolean name="flip_normals" value="true"/><emitter type="area">
        <spectrum name="radiance" value="400:1, 500:2, 600:3.5, 700:1"/></emitter></shape>
    <emitter type="spot"><blackbody name="intensity" temperature="3000K" scale="0.01"/>
        <float name="cutoff_angle" value="30"/></emitter>
</scene>
"""
