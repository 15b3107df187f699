# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Small valid files of every format, all made here; the same at every run."""

from __future__ import annotations

import io
import json
import struct
import tempfile
import zlib
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image as PillowImage

import eclat
from eclat.images.exr import encode_exr
from eclat.scenes import build
from fuzz.mutations import glb
from support.brdf_files import tensor_file
from support.compressed_files import COMPRESSED
from support.gltf_files import TRIANGLE, GltfFile, png_bytes
from support.mitsuba_files import WHOLE
from support.usd_files import SQUARE, usda

Files = dict[str, bytes]
"""Name → content; the first is the one that is loaded."""

PICTURE = (np.arange(5 * 4 * 4).reshape(5, 4, 4) * 7 % 256).astype(np.uint8)
QUAD = ((-1.0, 0.0, -1.0), (-1.0, 0.0, 1.0), (1.0, 0.0, 1.0), (1.0, 0.0, -1.0))


_ROOM = f"""
def Material "m" {{
    token outputs:surface.connect = </m/s.outputs:surface>
    def Shader "s" {{
        uniform token info:id = "UsdPreviewSurface"
        color3f inputs:diffuseColor.connect = </m/t.outputs:rgb>
        float inputs:roughness = 0.4
        token outputs:surface
    }}
    def Shader "t" {{
        uniform token info:id = "UsdUVTexture"
        asset inputs:file = @a.png@
        float4 inputs:bias = (0.1, 0, 0, 0)
        float2 inputs:st.connect = </m/r.outputs:result>
        float3 outputs:rgb
    }}
    def Shader "r" {{
        uniform token info:id = "UsdPrimvarReader_float2"
        string inputs:varname = "st"
        float2 outputs:result
    }}
}}
def Mesh "floor" (prepend apiSchemas = ["MaterialBindingAPI"]) {{
    {SQUARE}
    texCoord2f[] primvars:st = [(0, 0), (3, 0), (3, 2), (0, 2)] (interpolation = "faceVarying")
    int[] primvars:st:indices = [0, 1, 2, 3]
    rel material:binding = </m>
}}
def PointInstancer "many" {{
    rel prototypes = [</many/cone>]
    int[] protoIndices = [0, 0]
    point3f[] positions = [(0, 0, 0), (2, 0, 0)]
    def Cone "cone" {{ double radius = 0.5 }}
}}
def SphereLight "lamp" (prepend apiSchemas = ["ShapingAPI"]) {{
    float inputs:shaping:cone:angle = 40
    float inputs:intensity = 40
    double3 xformOp:translate = (0, 0, 2.5)
    uniform token[] xformOpOrder = ["xformOp:translate"]
}}
def DomeLight "sky" {{ asset inputs:texture:file = @a.png@ }}
def Camera "eye" {{ float focalLength = 24 }}
"""


def corpus() -> dict[str, list[Files]]:
    """Format → its seeds. Those that need a solve are made by the core: call this in a process of its own."""
    return {
        "gltf": _gltf(),
        "obj": _obj(),
        "ply": _ply(),
        "usd": _usd(),
        "mitsuba": _mitsuba(),
        "serialized": _serialized(),
        "dict": [{"scene.json": json.dumps(scene).encode()} for scene in (_DICT,)],
        "image": _images(),
        "points": _points(),
        "solved": _solved(),
        "brdf": _brdfs(),
        "brdf-cache": [_brdf_cache()],
        "settings": _settings(),
        "options": [{"options.json": json.dumps(_OPTIONS).encode()}],
    }


def _gltf() -> list[Files]:
    plain = GltfFile()
    texture = plain.texture(PICTURE, wrapS=33071, magFilter=9728)
    grey = plain.texture(PICTURE[..., :1])
    extensions = {
        "KHR_materials_transmission": {"transmissionFactor": 0.5, "transmissionTexture": {"index": grey}},
        "KHR_materials_volume": {"thicknessFactor": 0.1, "attenuationColor": [1, 0.5, 0.5]},
        "KHR_materials_ior": {"ior": 1.4},
        "KHR_materials_specular": {"specularFactor": 0.5, "specularColorFactor": [1, 0.9, 0.8]},
        "KHR_materials_emissive_strength": {"emissiveStrength": 4},
    }
    textured = {"index": texture, "texCoord": 0, "extensions": {"KHR_texture_transform": {"rotation": 0.3}}}
    rough = {"baseColorFactor": [0.8, 0.7, 0.6, 0.9], "baseColorTexture": textured, "roughnessFactor": 0.4}
    plain.append(
        "materials",
        {
            "pbrMetallicRoughness": {**rough, "metallicRoughnessTexture": {"index": texture}, "metallicFactor": 0.5},
            "normalTexture": {"index": texture, "scale": 0.8},
            "emissiveFactor": [0.2, 0.1, 0],
            "emissiveTexture": {"index": texture},
            "alphaMode": "MASK",
            "alphaCutoff": 0.4,
            "doubleSided": True,
            "extensions": extensions,
        },
    )
    uvs = plain.accessor([(0, 0), (0, 255), (255, 255), (255, 0)], "u1", normalized=True)
    quad = plain.primitive(QUAD, [0, 1, 2, 0, 2, 3], material=0)
    quad["attributes"] |= {
        "NORMAL": plain.accessor([(0, 1, 0)] * 4),
        "TANGENT": plain.accessor([(1, 0, 0, 1)] * 4),
        "TEXCOORD_0": uvs,
        "COLOR_0": plain.accessor([(1, 0.5, 0.25, 1)] * 4),
    }
    quad["targets"] = [{"POSITION": plain.accessor([(0, 0.1, 0)] * 4)}]
    plain.mesh_node(quad, weights=[0.5], translation=[0, 1, 0], rotation=[0, 0, 0, 1], scale=[2, 2, 2])
    strip = plain.primitive(QUAD, mode=5)
    sparse = {"count": 1, "indices": {"bufferView": plain.view(b"\1\0"), "componentType": 5123}}
    moved = plain.view(struct.pack("<3f", 0, 0.2, 0))
    plain.json["accessors"][strip["attributes"]["POSITION"]]["sparse"] = {**sparse, "values": {"bufferView": moved}}
    instances = {"TRANSLATION": plain.accessor([(0, 0, 0), (3, 0, 0)])}
    plain.mesh_node(strip, extensions={"EXT_mesh_gpu_instancing": {"attributes": instances}})
    lights: list[dict[str, Any]] = [
        {"type": "point", "intensity": 40, "color": [1, 0.9, 0.8]},
        {"type": "spot", "intensity": 30, "spot": {"innerConeAngle": 0.2, "outerConeAngle": 0.5}},
        {"type": "directional", "intensity": 3},
    ]
    plain.json["extensions"] = {"KHR_lights_punctual": {"lights": lights}}
    for index in range(3):
        plain.append("nodes", {"extensions": {"KHR_lights_punctual": {"light": index}}, "translation": [0, 3, 0]})
    plain.append("cameras", {"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1, "aspectRatio": 1}})
    matrix = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0.5, 5, 1]
    plain.append("nodes", {"camera": 0, "matrix": matrix, "children": []})
    plain.json["scenes"], plain.json["scene"] = [{"nodes": list(range(len(plain.json["nodes"])))}], 0
    small = GltfFile()
    small.mesh_node(small.primitive(TRIANGLE, [0, 1, 2]))
    split = {**plain.json, "buffers": [{"byteLength": len(plain.binary), "uri": "scene.bin"}]}
    split["images"] = [{"uri": "a.png"}, {"uri": "data:image/png;base64,AAAA"}]
    files = {"scene.bin": bytes(plain.binary), "a.png": png_bytes(PICTURE)}
    written = {**small.json, "buffers": [{"byteLength": len(small.binary)}]}
    return [
        {"scene.glb": plain.glb()},
        {"scene.glb": _moving_gltf()},
        {"scene.gltf": json.dumps(split).encode(), **files},
        {"scene.glb": glb(json.dumps(written).encode(), bytes(small.binary))},
        *({"scene.glb": (COMPRESSED / name).read_bytes()} for name in ("draco.glb", "meshopt.glb")),
    ]


def _moving_gltf() -> bytes:
    """A mesh with a skin and a morph target, a light and a material, all of which an animation changes."""
    file = GltfFile()
    skinned = file.primitive(QUAD, [0, 1, 2, 0, 2, 3], material=file.append("materials", {"emissiveFactor": [1, 1, 1]}))
    skinned["attributes"]["JOINTS_0"] = file.accessor([[0, 1, 0, 0]] * 4, "u1")
    skinned["attributes"]["WEIGHTS_0"] = file.accessor([[0.5, 0.5, 0, 0]] * 4)
    skinned["targets"] = [{"POSITION": file.accessor([(0, 0.1, 0)] * 4)}]
    joints = [file.append("nodes", {"translation": [0, n, 0]}) for n in range(2)]
    file.append("skins", {"joints": joints})
    node = file.mesh_node(skinned, skin=0, weights=[0.5])
    file.json["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 4}]}}
    file.append("nodes", {"extensions": {"KHR_lights_punctual": {"light": 0}}})
    light = {"KHR_animation_pointer": {"pointer": "/extensions/KHR_lights_punctual/lights/0/intensity"}}
    glow = {"KHR_animation_pointer": {"pointer": "/materials/0/emissiveFactor"}}
    quaternions = [[0, 0, 0, 1], [0, 0, 0.6, 0.8]]
    cubic = [[0, 0, 0], [0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 0, 0], [0, 0, 0]]
    targets: list[tuple[dict[str, Any], Any, str]] = [
        ({"node": joints[1], "path": "rotation"}, quaternions, "LINEAR"),
        ({"node": joints[0], "path": "translation"}, cubic, "CUBICSPLINE"),
        ({"node": node, "path": "weights"}, [0.0, 1.0], "STEP"),
        ({"path": "pointer", "extensions": light}, [1.0, 9.0], "LINEAR"),
        ({"path": "pointer", "extensions": glow}, [[0, 0, 0], [1, 2, 3]], "LINEAR"),
    ]
    times = file.accessor([0.0, 1.5])
    samplers = [{"input": times, "output": file.accessor(v), "interpolation": mode} for _, v, mode in targets]
    channels = [{"sampler": n, "target": target} for n, (target, _, _) in enumerate(targets)]
    file.append("animations", {"samplers": samplers, "channels": channels})
    return file.glb()


def _usd() -> list[Files]:
    """Text only: the package that reads `.usdc` may ask for gigabytes that a damaged file claims (docs/guides/service.md)."""
    return [{"scene.usda": usda(_ROOM).encode(), "a.png": png_bytes(PICTURE)}]


def _obj() -> list[Files]:
    vertices = "v -1 0 -1 0.5 0.5 1\nv -1 0 1 1 1 1\nv 1 0 1 1 0 0\nv 1 0 -1 0 1 0\nv 0 1.5 0 0 0 0\n"
    faces = (
        "vt 0 0\nvt 1 0\nvt 1 1\nvn 0 1 0\ng floor\nusemtl a\nf 1/1/1 2/2/1 3/3/1 4/1/1\ns 1\nusemtl b\nf -1 2// 1\n"
    )
    text = f"# made by a fuzzer\nmtllib scene.mtl\no part\n{vertices}{faces}usemtl lamp\nf 5/1 3/2 4/3\ns off\n"
    mtl = (
        "newmtl a\nKd 0.8 0.7 0.6\nKs 0.2 0.2 0.2\nNs 50\nillum 2\nmap_Kd -s 2 2 1 a.png\nmap_Bump -bm 0.1 a.png\n"
        "newmtl b\nKd 0.1 0.1 0.1\nNi 1.5\nTf 1 1 1\nd 0.5\nillum 7\nPr 0.3\nPm 0.5\nmap_d a.png\n"
        "newmtl lamp\nKe 10 10 8\nKd 0 0 0\n"
    )
    png = png_bytes(PICTURE)
    return [
        {"scene.obj": text.encode(), "scene.mtl": mtl.encode(), "a.png": png},
        {"scene.obj": b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"},
        {"scene.obj": ("\ufeff" + text).encode("utf-16"), "scene.mtl": mtl.encode(), "a.png": png},
    ]


def ply_file(encoding: str, texture: bool = False) -> bytes:
    """A quad, a triangle and a strip, with normals, colours and texture coordinates."""
    header = [
        *("ply", f"format {encoding} 1.0", "comment made by a fuzzer"),
        *(["comment TextureFile a.png"] if texture else []),
        *("element vertex 4", *(f"property float {name}" for name in ("x", "y", "z", "nx", "ny", "nz", "s", "t"))),
        *(f"property uchar {name}" for name in ("red", "green", "blue", "alpha")),
        *("element face 2", "property list uchar int vertex_indices"),
        *("element tristrips 1", "property list int int vertex_indices", "end_header"),
    ]
    rows: list[tuple[str, tuple[float, ...]]] = [
        ("8f4B", (*corner, 0, 1, 0, index / 4, 0.5, 255, 128, 64, 255)) for index, corner in enumerate(QUAD)
    ]
    rows += [("B4i", (4, 0, 1, 2, 3)), ("B3i", (3, 0, 1, 3)), ("i6i", (6, 0, 1, 2, -1, 2, 3))]
    if encoding == "ascii":
        body = "".join(" ".join(f"{value:g}" for value in values) + "\n" for _, values in rows).encode()
    else:
        order = "<" if "little" in encoding else ">"
        body = b"".join(struct.pack(order + code, *values) for code, values in rows)
    return ("\n".join(header) + "\n").encode() + body


def _ply() -> list[Files]:
    seeds: list[Files] = []
    for encoding in ("ascii", "binary_little_endian", "binary_big_endian"):
        seeds.append({"scene.ply": ply_file(encoding)})
    seeds.append({"scene.ply": ply_file("ascii", texture=True), "a.png": png_bytes(PICTURE)})
    return seeds


_ENVIRONMENT = """<emitter type="envmap"><string name="filename" value="sky.hdr"/>
    <transform name="to_world"><rotate x="1" angle="90"/></transform></emitter>
"""
_DAYLIGHT = """<emitter type="sunsky"><vector name="sun_direction" x="0.3" y="0.8" z="0.2"/>
    <float name="turbidity" value="3"/></emitter>
"""
_SHAPES = """<scene version="2.1.0">
    <sensor type="thinlens"><float name="fov" value="40"/><float name="aperture_radius" value="0.1"/>
        <transform name="to_world"><lookat origin="0, 2, 6" target="0, 0, 0" up="0, 1, 0"/></transform></sensor>
    <bsdf type="roughconductor" id="metal"><string name="material" value="Au"/><float name="alpha" value="0.1"/></bsdf>
    <bsdf type="mask" id="leaf"><float name="opacity" value="0.5"/><bsdf type="diffuse"><texture type="bitmap"
        name="reflectance"><string name="filename" value="a.png"/></texture></bsdf></bsdf>
    <shape type="ply"><string name="filename" value="a.ply"/><ref id="metal"/></shape>
    <shape type="obj"><string name="filename" value="a.obj"/><ref id="leaf"/></shape>
    <shape type="serialized"><string name="filename" value="a.serialized"/><integer name="shape_index" value="0"/>
        <bsdf type="dielectric"><float name="int_ior" value="1.5"/></bsdf></shape>
    <shape type="sphere"><point name="center" x="0" y="3" z="0"/><float name="radius" value="0.5"/>
        <bsdf type="blendbsdf"><float name="weight" value="0.3"/><bsdf type="diffuse"/><bsdf type="plastic"/></bsdf></shape>
    <shape type="cylinder"><point name="p0" x="0" y="0" z="0"/><point name="p1" x="0" y="1" z="0"/></shape>
    <shape type="disk"><emitter type="area"><rgb name="radiance" value="3 3 3"/></emitter></shape>
    <include filename="more.xml"/>
</scene>
"""
_MORE = '<scene version="2.1.0"><emitter type="constant"><rgb name="radiance" value="0.4"/></emitter></scene>'


_MOVING = """<shape type="cube"><animation name="toWorld"><transform time="0"><scale value="0.2"/></transform>
<transform time="1.5"><scale x="0.3"/><rotate y="1" angle="80"/><translate x="1"/></transform></animation></shape>"""


def _mitsuba() -> list[Files]:
    obj = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n"
    beside = {"a.ply": ply_file("binary_little_endian"), "a.obj": obj, "a.serialized": serialized_file(4)}
    sky = WHOLE.replace("</scene>", _ENVIRONMENT + "</scene>")
    files = {"more.xml": _MORE.encode(), "a.png": png_bytes(PICTURE), **beside}
    # Daylight takes as long as twenty other scenes.
    return [
        *[{"scene.xml": WHOLE.encode()}] * 4,
        *[{"scene.xml": WHOLE.replace("</scene>", _MOVING + "</scene>").encode()}] * 2,
        *[{"scene.xml": _SHAPES.encode(), **files}] * 4,
        *[{"scene.xml": sky.encode(), "sky.hdr": radiance_picture()}] * 4,
        {"scene.xml": WHOLE.replace("</scene>", _DAYLIGHT + "</scene>").encode()},
    ]


def serialized_file(version: int) -> bytes:
    """One shape in Mitsuba's compressed format."""
    body = struct.pack("<I", 0x1003) + (b"name\0" if version == 4 else b"") + struct.pack("<QQ", 4, 2)
    tables = (QUAD, [(0, 1, 0)] * 4, [(0, 0), (0, 1), (1, 1), (1, 0)])
    body += b"".join(np.asarray(table, "<f4").tobytes() for table in tables)
    body += np.array([(0, 1, 2), (0, 2, 3)], "<u4").tobytes()
    data = struct.pack("<HH", 0x041C, version) + zlib.compress(body)
    return data + struct.pack("<Q" if version == 4 else "<I", 0) + struct.pack("<I", 1)


def _serialized() -> list[Files]:
    xml = (
        '<scene version="2.1.0"><shape type="serialized"><string name="filename" value="a.serialized"/></shape></scene>'
    )
    return [{"a.serialized": serialized_file(version), "scene.xml": xml.encode()} for version in (3, 4)]


def radiance_picture() -> bytes:
    """A Radiance picture of 9 × 4 texels: three rows packed by runs, one flat."""
    rows = b""
    for _ in range(3):
        rows += b"\2\2\0\x09" + (b"\x89\x60" + b"\x84\x40\5abcde" + b"\x89\x20" + b"\x89\x81")
    return b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=1.0\n\n-Y 4 +X 9\n" + rows + b"\x20\x40\x60\x80" * 9


def _images() -> list[Files]:
    seeds: list[Files] = []
    rgba = PillowImage.fromarray(PICTURE)
    modes = {"rgba": rgba, "rgb": rgba.convert("RGB"), "grey": rgba.convert("L"), "bit": rgba.convert("1")}
    modes["palette"] = rgba.convert("RGB").convert("P")
    modes["deep"] = PillowImage.fromarray(PICTURE[..., 0].astype(np.uint16) * 257)
    wanted = {
        "PNG": ("rgba", "rgb", "grey", "bit", "palette", "deep"),
        "JPEG": ("rgb", "grey"),
        **dict.fromkeys(("BMP", "TIFF", "PCX", "GIF"), ("rgb", "palette")),
        **{"TGA": ("rgba", "palette"), "WEBP": ("rgba",), "PPM": ("rgb", "bit", "deep"), "DDS": ("rgba",)},
    }
    for kind, names in wanted.items():
        for name in names:
            file = io.BytesIO()
            modes[name].save(file, kind)
            seeds.append({f"a.{kind.lower()}": file.getvalue()})
    pixels = (PICTURE[..., :3] / 100).astype(np.float32)
    seeds.append({"a.exr": encode_exr(pixels, {}, {"x": 1}, {})})
    seeds.append({"a.hdr": radiance_picture()})
    seeds.append({"a.pfm": b"PF\n4 5\n-1.0\n" + pixels.astype("<f4").tobytes()})
    array = io.BytesIO()
    np.save(array, pixels)
    seeds.append({"a.npy": array.getvalue()})
    seeds += [{"a.ktx2": (COMPRESSED / name).read_bytes()} for name in ("etc1s.ktx2", "uastc_alpha.ktx2")]
    return seeds


def _points() -> list[Files]:
    text = b"x,y,z,nx,ny,nz\n0,0,0,0,1,0\n# a comment\n1 2 3 0 0 1\n-0.5;1e-3;2;1;1;0\n"
    array = io.BytesIO()
    np.save(array, np.arange(12.0).reshape(2, 6))
    return [{"a.txt": text}, {"a.npy": array.getvalue()}]


def _solved() -> list[Files]:
    scene = build("cornell-box")
    methods: list[tuple[Any, dict[str, Any]]] = [
        (eclat.IrradianceCache(max_error=0.5), {"points": ([[0.0, -1.0, 0.0]], [[0.0, 1.0, 0.0]])}),
        (eclat.RadianceCache(max_error=0.5, order=3), {"size": (4, 4)}),
        (eclat.PhotonMap(photons=1000, caustic_photons=1000), {}),
        (eclat.Radiosity(patches=100), {}),
    ]
    seeds: list[Files] = []
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.npz"
        for method, purpose in methods:
            eclat.solve(scene, method, check=False, threads=1, **purpose).save(path)
            seeds.append({"a.npz": _without_clock(path.read_bytes())})
    return seeds


def _without_clock(data: bytes) -> bytes:
    """The archive with statistics that do not depend on when it was made."""
    with np.load(io.BytesIO(data)) as archive:
        arrays = dict(archive)
    header = json.loads(str(arrays.pop("header")))
    header["statistics"] = {name: float(bool(value)) for name, value in header["statistics"].items()}
    file = io.BytesIO()
    np.savez(file, header=json.dumps(header), **arrays)
    return file.getvalue()


def _brdfs() -> list[Files]:
    """Small files of RGL, isotropic or not, and the beginning of one of MERL."""
    rng = np.random.default_rng(2)

    def fields(azimuths: int, **others: Any) -> dict[str, Any]:
        slices = (azimuths, 3)
        return {
            "phi_i": np.linspace(-np.pi, 0, azimuths, dtype="<f4"), "theta_i": np.linspace(0, 1.4, 3, dtype="<f4"),
            "ndf": rng.random((3, 4), np.float32), "sigma": rng.random((2, 3), np.float32) + np.float32(0.1),
            "vndf": rng.random((*slices, 4, 4), np.float32), "luminance": rng.random((*slices, 3, 3), np.float32),
            "jacobian": np.ones(1, np.uint8), **others,
        }  # fmt: skip

    rgb = fields(1, rgb=rng.random((1, 3, 3, 3, 3), np.float32))
    spectra = rng.random((4, 3, 5, 3, 3), np.float32)
    spectral = fields(4, spectra=spectra, wavelengths=np.linspace(360, 1000, 5, dtype="<f4"))
    return [
        {"paint.bsdf": tensor_file(rgb)},
        {"brushed.bsdf": tensor_file(spectral)},
        {"paint.binary": struct.pack("<3i3d", 90, 90, 180, 1, 2, 3)},
    ]


def _brdf_cache() -> Files:
    import os

    from eclat.brdf_table import brdf_table

    before = os.environ.get("XDG_CACHE_HOME")
    with tempfile.TemporaryDirectory() as folder:
        os.environ["XDG_CACHE_HOME"] = folder
        try:
            brdf_table("lambert", order=2, threads=1)
        finally:
            os.environ.pop("XDG_CACHE_HOME")
            if before is not None:
                os.environ["XDG_CACHE_HOME"] = before
        (path,) = (Path(folder) / "eclat").iterdir()
        return {f"eclat/{path.name}": path.read_bytes()}


def _settings() -> list[Files]:
    """Pictures that repeat their run."""
    from click.testing import CliRunner

    from eclat.cli import group

    seeds: list[Files] = []
    with tempfile.TemporaryDirectory() as folder:
        for suffix in (".png", ".exr"):
            path = Path(folder) / f"a{suffix}"
            flags = ["--samples", "1", "--size", "4x4", "--threads", "1", "--camera-from", "0,0,3", "--set", "rows=4"]
            done = CliRunner().invoke(group, ["render", "cornell-box", *flags, "-o", str(path)])
            assert done.exit_code == 0, done.output
            seeds.append({path.name: path.read_bytes()})
    return seeds


_DICT: dict[str, Any] = {
    "type": "scene",
    "sensor": {"type": "perspective", "fov": 40, "to_world": np.eye(4).tolist(), "film": {"type": "hdrfilm"}},
    "white": {"type": "diffuse", "id": "white", "reflectance": {"type": "rgb", "value": [0.8, 0.8, 0.8]}},
    "floor": {"type": "rectangle", "bsdf": {"type": "ref", "id": "white"}, "to_world": np.eye(4).tolist()},
    "ball": {"type": "sphere", "radius": 0.5, "center": [0, 0, -3], "bsdf": {"type": "roughplastic", "alpha": 0.2}},
    "board": {
        "type": "cube",
        "bsdf": {"type": "twosided", "a": {"type": "diffuse", "reflectance": {"type": "checkerboard"}}},
    },
    "lamp": {"type": "point", "position": [0, 0, 2], "intensity": {"type": "spectrum", "value": 3.0}},
    "sky": {"type": "constant", "radiance": {"type": "rgb", "value": 0.3}},
}
_OPTIONS: dict[str, Any] = {
    "irradiance-cache": {"max_error": 0.1, "rows": 4, "refine": True},
    "radiance-cache": {"max_error": 0.1, "order": 4},
    "photon-map": {"photons": 1000, "caustic_photons": 0},
    "radiosity": {"patches": 100},
    "path": {},
    "direct": {},
}
