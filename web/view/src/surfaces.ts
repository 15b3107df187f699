// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The meshes of the scene, with the materials of the geometry pass and of shadow maps.

import * as three from 'three';
import {
  arrayOf,
  type LightHeader,
  type MaterialEntry,
  type MeshEntry,
  type Message,
  type SceneHeader,
  type TextureEntry,
  type Value,
  type Wrap,
} from './messages';
import { Planes, type Plane } from './mirrors';
import { shadowFragment, surfaceFragment, surfaceVertex } from './shaders/surfaces';

const GLOSS = { none: 0, rough: 1, mirror: 2, glass: 3 };

const WRAPS: Record<Wrap, three.Wrapping> = {
  repeat: three.RepeatWrapping,
  mirror: three.MirroredRepeatWrapping,
  clamp: three.ClampToEdgeWrapping,
};

/** What all materials of a pass share: the camera or light that sees the surfaces. */
export interface View {
  readonly viewProjection: { value: three.Matrix4 };
  readonly eye: { value: three.Vector4 };
  /** Nothing is drawn behind this plane: its normal and offset. */
  readonly clip: { value: three.Vector4 };
  /** The depth at which perspective views begin, m, as a logarithm of 2, and one over the logarithm of how much deeper they end. */
  readonly depths: { value: three.Vector2 };
  /** Whether a mirrored eye sees, which sees what is hidden from the camera. */
  readonly inMirror: { value: boolean };
}

/** The plane of a view that shows everything. */
export const NO_CLIP = new three.Vector4(0, 0, 0, -1);

export function makeView(): View {
  return { viewProjection: { value: new three.Matrix4() }, eye: { value: new three.Vector4() }, clip: { value: NO_CLIP.clone() }, depths: { value: new three.Vector2(0, 1) }, inMirror: { value: false } };
}

export interface Surfaces {
  /** For the geometry pass, without glass. */
  readonly seen: three.Scene;
  /** The same surfaces, without glass, as lights see them. */
  readonly shading: three.Scene;
  /** Glass, which a pass of its own draws over the picture. */
  readonly glass: three.Scene;
  readonly bounds: three.Box3;
  /** Names of the materials, by number. */
  readonly materials: readonly string[];
  readonly triangles: number;
  /** The planes of what mirrors. */
  readonly planes: readonly Plane[];
  /** The roughness α of the materials, by number. */
  readonly alphas: three.DataTexture;
  /** The roughness α of a material. */
  roughness(material: number): number;
}

/** Where the light of a sun goes, for shadow maps. */
export interface ShadowView extends View {
  readonly sunDirection: { value: three.Vector3 };
}

/** Builds the surfaces. */
export async function makeSurfaces(
  message: Message<SceneHeader>,
  light: Message<LightHeader>,
  view: View,
  lamp: ShadowView,
): Promise<Surfaces> {
  const { header } = message;
  const textures = await Promise.all(header.textures.map((entry) => makeTexture(message, entry)));
  const lightMap = floatTexture(light, 'map');
  const { moments } = light.header;
  const [momentR, momentG, momentB] = ['moment_r', 'moment_g', 'moment_b'].map((name) => (moments ? floatTexture(light, name) : null));
  const scale = { value: 1 / light.header.scale };
  const seen = new three.Scene();
  const shading = new three.Scene();
  const glass = new three.Scene();
  const bounds = new three.Box3();
  const planes = new Planes(diagonalOf(message));
  let triangles = 0;
  for (const entry of header.meshes) {
    const material = header.materials[entry.material];
    if (!material) throw new Error(`The mesh ${entry.name} has no material.`);
    const geometry = makeGeometry(message, entry, material.relief?.map);
    triangles += geometry.getAttribute('position').count / 3;
    bounds.union(geometry.boundingBox ?? new three.Box3());
    const isGlass = material.gloss === 'glass';
    if (material.gloss !== 'none' && material.alpha < FLAT_MIRROR) {
      const bothSides = isGlass || (material.two_sided && !entry.front_only);
      planes.add(geometry.getAttribute('position').array as Float32Array, bothSides);
    }
    const uniforms = surfaceUniforms(entry, material, textures);
    const shown = {
      ...uniforms,
      ...view,
      number: { value: entry.material + 1 },
      lightMap: { value: lightMap },
      lightScale: scale,
      momentR: { value: momentR },
      momentG: { value: momentG },
      momentB: { value: momentB },
      hasMoments: { value: moments },
      hasLight: { value: entry.arrays.light_uvs !== undefined },
    };
    (isGlass ? glass : seen).add(surface(geometry, surfaceFragment, shown, material.relief ? { RELIEF: '' } : {}));
    if (!isGlass) shading.add(surface(geometry, shadowFragment, { ...uniforms, ...lamp }));
  }
  const materials = header.materials.map((m) => m.name);
  const roughness = (material: number) => header.materials[material]?.alpha ?? 0;
  return { seen, shading, glass, bounds, materials, triangles, planes: planes.largest(), alphas: alphasOf(header.materials), roughness };
}

/** The length of the diagonal of the scene in metres. */
function diagonalOf(message: Message<SceneHeader>): number {
  const bounds = new three.Box3();
  const point = new three.Vector3();
  for (const entry of message.header.meshes) {
    const positions = entry.arrays.positions === undefined ? [] : arrayOf(message, entry.arrays.positions).data;
    for (let i = 0; i < positions.length; i += 3) bounds.expandByPoint(point.fromArray(positions, i));
  }
  return bounds.getSize(new three.Vector3()).length();
}

/** The roughness α above which a plane's mirrored picture is not worth drawing. */
const FLAT_MIRROR = 0.35;

function alphasOf(materials: readonly MaterialEntry[]): three.DataTexture {
  const values = Float32Array.from(materials, (material) => material.alpha);
  const texture = new three.DataTexture(values, values.length, 1, three.RedFormat, three.FloatType);
  texture.needsUpdate = true;
  return texture;
}

function surface(
  geometry: three.BufferGeometry,
  fragmentShader: string,
  uniforms: Uniforms,
  defines: Record<string, string> = {},
): three.Mesh {
  const material = new three.RawShaderMaterial({
    glslVersion: three.GLSL3,
    vertexShader: withoutVersion(surfaceVertex),
    fragmentShader: withoutVersion(fragmentShader),
    uniforms,
    defines, // the software that draws without a graphics card takes long to compile what no surface needs
    side: three.DoubleSide, // the shader knows better which sides are seen, also where a camera mirrors
  });
  const mesh = new three.Mesh(geometry, material);
  mesh.frustumCulled = false;
  return mesh;
}

/** three.js writes the version itself. */
export function withoutVersion(shader: string): string {
  return shader.replace('#version 300 es\n', '');
}

type Uniforms = Record<string, three.IUniform>;

function surfaceUniforms(entry: MeshEntry, material: MaterialEntry, textures: readonly three.Texture[]): Uniforms {
  const uniforms: Uniforms = {
    gloss: { value: GLOSS[material.gloss] },
    frontOnly: { value: entry.front_only },
    twoSided: { value: material.two_sided },
    culled: { value: material.culled },
    hidden: { value: material.hidden },
    vertexColors: { value: material.vertex_colors && entry.arrays.colors !== undefined },
    emissionTwoSided: { value: material.emission_two_sided },
    cutoff: { value: material.cutoff },
    coat: { value: material.coat },
    mirrored: { value: vectors(material.mirrored) },
    metal: { value: material.metal },
    inside: { value: material.inside },
    saturates: { value: material.saturates },
    isHeight: { value: material.relief?.kind === 'bump' },
    reliefScale: { value: material.relief?.scale ?? 0 },
    back: { value: entry.back },
    hasTangents: { value: material.relief?.kind === 'normal' && entry.arrays.tangents !== undefined },
  };
  const { diffuse, metallic, transmission, emission, opacity } = material;
  const relief = material.relief?.map ?? { constant: [0, 0, 0] as const };
  for (const [name, value] of Object.entries({ diffuse, metallic, transmission, emission, opacity, relief })) {
    uniforms[name] = { value: valueUniform(value) };
    uniforms[`${name}Map`] = { value: value.texture === undefined ? null : textures[value.texture] };
  }
  return uniforms;
}

function vectors(numbers: readonly number[]): three.Vector3[] {
  return Array.from({ length: numbers.length / 3 }, (_, i) => new three.Vector3().fromArray(numbers, 3 * i));
}

function valueUniform(value: Value): Record<string, unknown> {
  const [a = 1, b = 0, c = 0, d = 0, e = 1, f = 0] = value.transform ?? [];
  return {
    constant: new three.Vector3(...value.constant),
    transform: new three.Matrix3(a, b, c, d, e, f, 0, 0, 1),
    uvSet: value.uv_set ?? 0,
    channel: value.channel ?? -1,
    textured: value.texture !== undefined,
    invert: value.invert ?? false,
    square: value.square ?? false,
  };
}

/** Makes a geometry of separate triangles, because each has the normal of its plane, as the core computes it. */
function makeGeometry(message: Message<SceneHeader>, entry: MeshEntry, relief?: Value): three.BufferGeometry {
  const triangles = entry.arrays.triangles === undefined ? undefined : arrayOf(message, entry.arrays.triangles).data;
  if (!triangles) throw new Error(`The mesh ${entry.name} has no triangles.`);
  const corners = (name: 'positions' | 'normals' | 'uvs' | 'uvs2' | 'colors' | 'tangents' | 'light_uvs', width: number) => {
    const key = entry.arrays[name];
    if (key === undefined) return undefined;
    const { data } = arrayOf(message, key);
    const spread = new Float32Array(triangles.length * width);
    for (let corner = 0; corner < triangles.length; ++corner) {
      const from = (triangles[corner] ?? 0) * width;
      for (let i = 0; i < width; ++i) spread[corner * width + i] = data[from + i] ?? 0;
    }
    return spread;
  };
  const geometry = new three.BufferGeometry();
  const positions = corners('positions', 3) ?? new Float32Array(0);
  const faces = faceNormals(positions);
  const set = (name: string, values: Float32Array | undefined, width: number) => {
    if (values) geometry.setAttribute(name, new three.BufferAttribute(values, width));
  };
  set('position', positions, 3);
  set('faceNormal', faces, 3);
  set('normal', corners('normals', 3) ?? faces, 3);
  set('uv', corners('uvs', 2), 2);
  set('uv2', corners('uvs2', 2), 2);
  set('lightUv', corners('light_uvs', 2), 2);
  set('color', corners('colors', 4), 4);
  set('tangent', corners('tangents', 4), 4);
  const places = relief && corners(relief.uv_set === 1 ? 'uvs2' : 'uvs', 2);
  if (relief && places) {
    const [along, across] = derivatives(positions, places, relief.transform);
    set('alongU', along, 3);
    set('alongV', across, 3);
  }
  geometry.computeBoundingBox();
  return geometry;
}

/** The derivatives of positions along the coordinates of a map, constant on each triangle; 0 where the coordinates do not tell. */
function derivatives(positions: Float32Array, uvs: Float32Array, transform: Value['transform']): [Float32Array, Float32Array] {
  const [a = 1, b = 0, , c = 0, d = 1] = transform ?? [];
  const [alongU, alongV] = [new Float32Array(positions.length), new Float32Array(positions.length)];
  for (let corner = 0; corner < positions.length / 3; corner += 3) {
    const turned = (k: number) => {
      const u = (uvs[2 * (corner + k)] ?? 0) - (uvs[2 * corner] ?? 0), v = (uvs[2 * (corner + k) + 1] ?? 0) - (uvs[2 * corner + 1] ?? 0);
      return [a * u + b * v, c * u + d * v] as const;
    };
    const [[u1, v1], [u2, v2]] = [turned(1), turned(2)];
    const determinant = u1 * v2 - v1 * u2;
    if (determinant === 0) continue;
    for (let i = 0; i < 9; ++i) {
      const at = 3 * corner + (i % 3), from = positions[at] ?? 0;
      const [e1, e2] = [(positions[at + 3] ?? 0) - from, (positions[at + 6] ?? 0) - from];
      alongU[3 * corner + i] = (e1 * v2 - e2 * v1) / determinant;
      alongV[3 * corner + i] = (e2 * u1 - e1 * u2) / determinant;
    }
  }
  return [alongU, alongV];
}

function faceNormals(positions: Float32Array): Float32Array {
  const normals = new Float32Array(positions.length);
  const [a, b, c] = [new three.Vector3(), new three.Vector3(), new three.Vector3()];
  for (let i = 0; i < positions.length; i += 9) {
    a.fromArray(positions, i);
    b.fromArray(positions, i + 3).sub(a);
    c.fromArray(positions, i + 6).sub(a);
    b.cross(c).normalize();
    for (let k = 0; k < 9; k += 3) b.toArray(normals, i + k);
  }
  return normals;
}

/** Makes a texture of half floats (H, W, 4). */
export function floatTexture(message: Message<SceneHeader> | Message<LightHeader>, name: string): three.DataTexture {
  const { data, shape } = arrayOf(message, name);
  const [height, width] = shape;
  const texture = new three.DataTexture(data as Uint16Array<ArrayBuffer>, width, height, three.RGBAFormat, three.HalfFloatType);
  texture.minFilter = texture.magFilter = three.LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

async function makeTexture(message: Message<SceneHeader>, entry: TextureEntry): Promise<three.Texture> {
  const texture = entry.png ? new three.Texture(await imageOf(message, entry)) : floatTexture(message, entry.array);
  texture.colorSpace = entry.srgb ? three.SRGBColorSpace : three.NoColorSpace;
  texture.flipY = false;
  [texture.wrapS, texture.wrapT] = [WRAPS[entry.wrap[0]], WRAPS[entry.wrap[1]]];
  if (entry.nearest) {
    texture.minFilter = texture.magFilter = three.NearestFilter;
  } else if (entry.png) {
    texture.generateMipmaps = true;
    texture.minFilter = three.LinearMipmapLinearFilter;
    texture.anisotropy = 8;
  }
  texture.needsUpdate = true;
  return texture;
}

function imageOf(message: Message<SceneHeader>, entry: TextureEntry): Promise<ImageBitmap> {
  const bytes = arrayOf(message, entry.array).data as Uint8Array<ArrayBuffer>;
  return createImageBitmap(new Blob([bytes], { type: 'image/png' }), {
    colorSpaceConversion: 'none',
    premultiplyAlpha: 'none',
  });
}
