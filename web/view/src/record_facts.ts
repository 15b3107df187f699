// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// What a record holds, in words and numbers.

import * as three from 'three';
import type { Gloss } from './gloss';
import type { Shown } from './hemisphere';
import type { SceneHeader } from './messages';
import { FLOATS, type Rows } from './rows';

/** Stands for infinite lengths in rows. */
const FARTHEST = 1e29;

/** Records, of irradiance or of radiance. */
interface WithRows {
  readonly rows: Rows;
}

/** A record of irradiance, for the view of its hemisphere. */
export function irradianceShown(records: WithRows, number: number): Shown {
  const row = records.rows.values.subarray(number * FLOATS, (number + 1) * FLOATS);
  const vector = (a: number, b: number, c: number) => new three.Vector3(row[a], row[b], row[c]);
  const luminance = (r: three.Vector3, g: three.Vector3, b: three.Vector3) =>
    r.multiplyScalar(0.2126).addScaledVector(g, 0.7152).addScaledVector(b, 0.0722);
  const irradiance = vector(12, 13, 14).dot(new three.Vector3(0.2126, 0.7152, 0.0722));
  return {
    place: vector(0, 1, 2),
    normal: vector(4, 5, 6),
    moving: luminance(vector(23, 27, 31), vector(32, 33, 34), vector(35, 18, 19)),
    turning: luminance(vector(20, 21, 22), vector(24, 25, 26), vector(28, 29, 30)),
    irradiance,
    radius: row[3] ?? 0,
  };
}

/** A record of radiance, for the view of its hemisphere. */
export function radianceShown(gloss: Gloss, number: number): Shown {
  const values = gloss.coefficientsOf(number).subarray(0, 4 * gloss.order ** 2);
  return { ...irradianceShown(gloss, number), coefficients: values };
}

export function recordFacts(records: WithRows, number: number, header: SceneHeader): [string, string][] {
  const row = records.rows.values.subarray(number * FLOATS, (number + 1) * FLOATS);
  const at = (i: number) => row[i] ?? 0;
  const vector = (...indices: number[]) => indices.map((i) => digits(at(i))).join(', ');
  const length = (...indices: number[]) => Math.hypot(...indices.map(at));
  const metres = (x: number) => (x < FARTHEST ? `${digits(x)} m` : 'unlimited');
  const unit = header.photometric ? 'lx' : 'W/m²';
  const position = [0, 1, 2].map((i) => digits(at(i) + (header.center[i] ?? 0))).join(', ');
  return [
    ['Number', String(number)],
    ['Position', `${position} m`],
    ['Normal', vector(4, 5, 6)],
    ['Radius', metres(at(3))],
    ['Elongation', digits(at(11))],
    ['Length that it follows', metres(at(48))],
    ['Nearest obstacle', metres(at(7))],
    ['Irradiance', `${vector(12, 13, 14)} ${unit}`],
    ['Shared excess', `${vector(15, 16, 17)} ${unit}`],
    ['Green per metre', `${digits(length(32, 33, 34))} ${unit}/m`],
    ['Green per radian', `${digits(length(24, 25, 26))} ${unit}/rad`],
    ['Curvature', `${digits(at(51))} ${unit}/m²`],
    ['Noise', `${digits(100 * at(49))} %`],
  ];
}

function digits(x: number): string {
  return Number(x.toPrecision(4)).toString();
}
