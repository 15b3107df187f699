// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// What a record sees, as the server renders it: radiance, distances, and the radiance as harmonics up to an order, each on a
// disc; and the record's gradients as arrows.

import * as three from 'three';
import { arrayOf, type HemisphereHeader, type Message } from './messages';

/** Pixels of a disc on the page. */
const SHOWN = 144;

/** Length of the longest arrow, in radii of the disc. */
const LONGEST = 0.8;

/** What is known of a record without the server. */
export interface Shown {
  readonly place: three.Vector3;
  readonly normal: three.Vector3;
  /** The gradients of the luminance of irradiance, W/m³ and W/m² per radian; radiance has none. */
  readonly moving?: three.Vector3;
  readonly turning?: three.Vector3;
  readonly irradiance: number;
  readonly radius: number;
  /** The values (order², 4) of a record of radiance. */
  readonly coefficients?: Float32Array;
}

/** How the discs are shown. */
export interface Shading {
  readonly exposure: number;
  readonly order: number;
}

export class HemisphereView {
  readonly element = document.createElement('div');
  private readonly discs = ['Radiance', 'Distances', 'Harmonics'].map((name) => disc(name));
  private readonly told = document.createElement('p');
  private record: Shown | undefined;
  private message: Message<HemisphereHeader> | undefined;

  constructor() {
    this.element.className = 'hemisphere';
    this.element.hidden = true;
    this.element.append(...this.discs.map(({ figure }) => figure), this.told);
  }

  /** Forgets what was shown, and begins with a record; nothing hides the discs. */
  begin(record: Shown | undefined): void {
    this.record = record;
    this.message = undefined;
    this.element.hidden = record === undefined;
    this.told.textContent = 'The server renders what this record sees.';
    for (const { canvas } of this.discs) canvas.getContext('2d')?.clearRect(0, 0, SHOWN, SHOWN);
  }

  accept(message: Message<HemisphereHeader>, shading: Shading): void {
    this.message = message;
    this.draw(shading);
  }

  /** Draws the discs anew, where there are any. */
  draw(shading: Shading): void {
    const { message, record } = this;
    if (!message || !record) return;
    const radiance = arrayOf(message, 'radiance').data as Float32Array;
    const distances = arrayOf(message, 'distances').data as Float32Array;
    const order = Math.min(message.header.order, shading.order);
    const harmonics = this.harmonics(message, record, order);
    const [side = 0] = arrayOf(message, 'radiance').shape;
    const scale = 2 ** shading.exposure;
    const farthest = distances.reduce((a, b) => Math.max(a, b), 1e-30);
    const color = (values: Float32Array) => (texel: number) =>
      [0, 1, 2].map((c) => encoded(scale * (values[3 * texel + c] ?? 0))) as [number, number, number];
    const far = (texel: number): [number, number, number] => {
      const share = 255 * Math.sqrt((distances[texel] ?? 0) / farthest);
      return [share, share, share];
    };
    const painters = [color(radiance), far, color(harmonics)];
    this.discs.forEach(({ canvas }, i) => paint(canvas, side, painters[i] ?? far));
    const first = this.discs[0];
    if (first) arrows(first.canvas, record);
    const source = record.coefficients ? 'of the record' : 'of the radiance beside it';
    this.told.textContent =
      `The normal is in the middle, the horizon at the rim; distances up to ${farthest.toPrecision(3)} m. The harmonics up to order ` +
      `${order} are those ${source}. Arrows: where irradiance grows, yellow along the surface, blue as the normal turns.`;
  }

  private harmonics(message: Message<HemisphereHeader>, record: Shown, order: number): Float32Array {
    const basis = arrayOf(message, 'basis').data as Float32Array;
    const [texels = 0, count = 0] = arrayOf(message, 'basis').shape;
    const own = record.coefficients;
    const coefficients = own ?? (arrayOf(message, 'coefficients').data as Float32Array);
    const stride = own ? 4 : 3;
    const used = Math.min(order * order, count, coefficients.length / stride);
    const values = new Float32Array(3 * texels);
    for (let texel = 0; texel < texels; ++texel) {
      for (let i = 0; i < used; ++i) {
        const b = basis[texel * count + i] ?? 0;
        for (let c = 0; c < 3; ++c) values[3 * texel + c]! += b * (coefficients[stride * i + c] ?? 0);
      }
    }
    return values;
  }
}

function disc(name: string): { figure: HTMLElement; canvas: HTMLCanvasElement } {
  const figure = document.createElement('figure');
  const canvas = document.createElement('canvas');
  canvas.width = canvas.height = SHOWN;
  canvas.setAttribute('role', 'img');
  canvas.setAttribute('aria-label', `${name} over the hemisphere of the record`);
  figure.append(canvas, Object.assign(document.createElement('figcaption'), { textContent: name }));
  return { figure, canvas };
}

/** Paints the texels of a disc, the first row at the bottom. */
function paint(canvas: HTMLCanvasElement, side: number, color: (texel: number) => readonly [number, number, number]): void {
  const context = canvas.getContext('2d');
  if (!context) return;
  const image = context.createImageData(SHOWN, SHOWN);
  for (let y = 0; y < SHOWN; ++y) {
    for (let x = 0; x < SHOWN; ++x) {
      if (Math.hypot(x + 0.5 - SHOWN / 2, y + 0.5 - SHOWN / 2) > SHOWN / 2) continue;
      const texel = Math.floor(((SHOWN - 1 - y) * side) / SHOWN) * side + Math.floor((x * side) / SHOWN);
      image.data.set([...color(texel), 255], 4 * (y * SHOWN + x));
    }
  }
  context.putImageData(image, 0, 0);
}

/** The axes u and v of the frame around a normal, as `Frame::around` of the core makes them. */
export function frameAround(n: three.Vector3): [three.Vector3, three.Vector3] {
  const sign = n.z < 0 || Object.is(n.z, -0) ? -1 : 1;
  const a = -1 / (sign + n.z);
  const b = n.x * n.y * a;
  return [new three.Vector3(1 + sign * n.x * n.x * a, sign * b, -sign * n.x), new three.Vector3(b, sign + n.y * n.y * a, -n.y)];
}

/**
 * Draws gradients as arrows from the middle. The length of an arrow is the change over the radius of the record, or over one
 * radian, in units of the irradiance.
 */
function arrows(canvas: HTMLCanvasElement, { normal, moving, turning, irradiance, radius }: Shown): void {
  const [u, v] = frameAround(normal);
  // Turning the normal about an axis g moves it towards g × n.
  const towards = turning?.clone().cross(normal);
  if (moving) arrow(canvas, moving.dot(u), moving.dot(v), radius / irradiance, '#ffd21f');
  if (towards) arrow(canvas, towards.dot(u), towards.dot(v), 1 / irradiance, '#4db4ff');
}

function arrow(canvas: HTMLCanvasElement, x: number, y: number, scale: number, color: string): void {
  const context = canvas.getContext('2d');
  const length = Math.hypot(x, y);
  if (!context || !(length > 0) || !Number.isFinite(scale)) return;
  const shown = (Math.min(LONGEST, length * scale) * SHOWN) / 2;
  const [dx, dy] = [x / length, -y / length];
  const [tipX, tipY] = [SHOWN / 2 + shown * dx, SHOWN / 2 + shown * dy];
  for (const [style, width] of [['#000', 4], [color, 2]] as const) {
    context.strokeStyle = style;
    context.lineWidth = width;
    context.beginPath();
    context.moveTo(SHOWN / 2, SHOWN / 2);
    context.lineTo(tipX, tipY);
    context.lineTo(tipX - 6 * dx - 4 * dy, tipY - 6 * dy + 4 * dx);
    context.moveTo(tipX, tipY);
    context.lineTo(tipX - 6 * dx + 4 * dy, tipY - 6 * dy - 4 * dx);
    context.stroke();
  }
}

function encoded(x: number): number {
  const y = Math.max(0, Math.min(1, x));
  return 255 * (y <= 0.0031308 ? 12.92 * y : 1.055 * y ** (1 / 2.4) - 0.055);
}
