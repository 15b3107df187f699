// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Decodes the messages of the server; python/eclat/viewer/messages.py describes the format.

export const VERSION = 1;

export type NumberArray = Float32Array | Uint32Array | Uint16Array | Uint8Array;

/** An array of a message; half floats are left as 16 bits, which the graphics card reads. */
export interface MessageArray {
  readonly data: NumberArray;
  readonly shape: readonly number[];
}

export interface Message<Header> {
  readonly header: Header;
  readonly arrays: ReadonlyMap<string, MessageArray>;
}

/** A parameter of a material: a constant, multiplied by the texel if there is a texture. */
export interface Value {
  readonly constant: readonly [number, number, number];
  readonly texture?: number;
  readonly channel?: number;
  readonly uv_set?: number;
  readonly transform?: readonly number[];
  readonly invert?: boolean;
  readonly square?: boolean;
}

export interface MaterialEntry {
  readonly name: string;
  readonly two_sided: boolean;
  readonly culled: boolean;
  readonly hidden: boolean;
  readonly vertex_colors: boolean;
  readonly emission_two_sided: boolean;
  readonly cutoff: number;
  readonly diffuse: Value;
  readonly metallic: Value;
  readonly transmission: Value;
  readonly emission: Value;
  readonly opacity: Value;
  /** A normal map or a height map; `scale` is that of the slopes, or the height of white in metres. */
  readonly relief: { readonly kind: 'normal' | 'bump'; readonly scale: number; readonly map: Value } | null;
  readonly gloss: 'none' | 'rough' | 'mirror' | 'glass';
  readonly mirrored: readonly number[];
  readonly metal: readonly number[];
  readonly alpha: number;
  readonly coat: readonly number[];
  readonly inside: number;
  readonly saturates: boolean;
}

export interface TextureEntry {
  readonly array: string;
  readonly png: boolean;
  readonly srgb: boolean;
  readonly wrap: readonly [Wrap, Wrap];
  readonly nearest: boolean;
  readonly channels: number;
}
export type Wrap = 'repeat' | 'mirror' | 'clamp';

export type MeshArray = 'positions' | 'triangles' | 'normals' | 'uvs' | 'uvs2' | 'colors' | 'tangents' | 'light_uvs';

export interface MeshEntry {
  readonly name: string;
  readonly material: number;
  readonly front_only: boolean;
  /** Whether it is the reversed side of another mesh. */
  readonly back: boolean;
  readonly arrays: Readonly<Partial<Record<MeshArray, string>>>;
}

export interface CameraEntry {
  readonly name: string;
  /** Row-major, from the camera, which looks along −z, to the scene. */
  readonly to_world: readonly number[];
  readonly half_extent: readonly [number, number];
  readonly fov: number;
  readonly fov_axis: 'x' | 'y' | 'smaller' | 'larger' | 'diagonal';
  readonly orthographic: boolean;
  readonly shift: readonly [number, number];
  readonly size: readonly [number, number];
}

export interface PointEntry {
  readonly kind: 'point';
  readonly position: readonly [number, number, number];
  readonly intensity: readonly [number, number, number];
}
export interface SpotEntry {
  readonly kind: 'spot';
  readonly position: readonly [number, number, number];
  readonly intensity: readonly [number, number, number];
  readonly direction: readonly [number, number, number];
  readonly inner_angle: number;
  readonly outer_angle: number;
  readonly smooth: boolean;
}
export interface SunEntry {
  readonly kind: 'sun';
  readonly direction: readonly [number, number, number];
  readonly irradiance: readonly [number, number, number];
  /** In degrees. */
  readonly angular_radius: number;
}
export type LightEntry = PointEntry | SpotEntry | SunEntry;

export interface SceneHeader {
  readonly kind: 'scene';
  readonly name: string;
  readonly center: readonly [number, number, number];
  readonly up: readonly [number, number, number];
  readonly photometric: boolean;
  readonly exposure: number;
  readonly cameras: readonly CameraEntry[];
  readonly lights: readonly LightEntry[];
  readonly sky: { readonly array: string; readonly to_world: readonly number[] } | null;
  readonly materials: readonly MaterialEntry[];
  readonly textures: readonly TextureEntry[];
  readonly meshes: readonly MeshEntry[];
  readonly notes: readonly string[];
}

export interface LightHeader {
  readonly kind: 'light';
  readonly scale: number;
  /** Whether the message has from where the light comes. */
  readonly moments: boolean;
}

/** How records are read. */
export interface Reading {
  readonly weight: 'tabellion' | 'ward' | 'split-sphere';
  readonly relaxation: number;
  readonly rotation_gradient: boolean;
  readonly translation_gradient: boolean;
  readonly spacing: number;
  readonly method: string;
}

export interface RecordsHeader {
  readonly kind: 'records';
  readonly first: number;
  readonly count: number;
  readonly reading: Reading;
}

export interface GlossHeader {
  readonly kind: 'gloss';
  readonly first: number;
  readonly count: number;
  readonly reading: Reading;
  readonly order: number;
  readonly grid: number;
}

/** A picture of the server: arrays `first` and `second` (height, width, 3), whose mean it is. */
export interface TruthHeader {
  readonly kind: 'truth';
  /** The number of the request. */
  readonly number: number;
  readonly samples: number;
}

/** What a record sees: arrays `radiance`, `distances`, `coefficients` and `basis` (python/eclat/viewer/hemisphere.py). */
export interface HemisphereHeader {
  readonly kind: 'hemisphere';
  /** The number of the request. */
  readonly number: number;
  readonly order: number;
}

export type Header = HemisphereHeader | TruthHeader | GlossHeader | SceneHeader | LightHeader | RecordsHeader;

/** Decodes a message of a kind. Throws an Error if it is not one of this version. */
export function decodeMessage<H extends Header>(buffer: ArrayBuffer, kind: H['kind']): Message<H> {
  const message = decodeAny(buffer, kind);
  if (message.header.kind !== kind) throw new Error(`Expected the ${kind} of a scene, got its ${message.header.kind}.`);
  return message as Message<H>;
}

/** Decodes a message of any kind, which errors call `what`. */
export function decodeAny(buffer: ArrayBuffer, what: string): Message<Header> {
  const view = new DataView(buffer);
  if (buffer.byteLength < 12 || view.getUint32(0) !== 0x45434c56) throw new Error(`The ${what} is not a message of Éclat.`);
  const version = view.getUint32(4, true);
  if (version !== VERSION) {
    throw new Error(`This page reads version ${VERSION} of the viewer's format, and the ${what} has version ${version}.`);
  }
  const text = new TextDecoder().decode(new Uint8Array(buffer, 12, view.getUint32(8, true)));
  const header = JSON.parse(text) as Header & { arrays: Record<string, { type: string; shape: number[]; offset: number }> };
  const arrays = new Map<string, MessageArray>();
  for (const [name, entry] of Object.entries(header.arrays)) {
    const count = entry.shape.reduce((product, length) => product * length, 1);
    arrays.set(name, { data: typed(entry.type, buffer, entry.offset, count), shape: entry.shape });
  }
  return { header, arrays };
}

function typed(type: string, buffer: ArrayBuffer, offset: number, count: number): NumberArray {
  switch (type) {
    case 'f4':
      return new Float32Array(buffer, offset, count);
    case 'u4':
      return new Uint32Array(buffer, offset, count);
    case 'f2':
    case 'u2':
      return new Uint16Array(buffer, offset, count);
    case 'u1':
      return new Uint8Array(buffer, offset, count);
    default:
      throw new Error(`The type ${type} of an array is unknown.`);
  }
}

/** Returns an array that the message must have. */
export function arrayOf(message: Message<Header>, name: string): MessageArray {
  const found = message.arrays.get(name);
  if (!found) throw new Error(`The ${message.header.kind} lacks the array ${name}.`);
  return found;
}
