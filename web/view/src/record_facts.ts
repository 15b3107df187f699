// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// What a record holds, in words and numbers.

import type { SceneHeader } from './messages';
import type { Records } from './records';
import { FLOATS } from './rows';

/** Stands for infinite lengths in rows. */
const FARTHEST = 1e29;

export function recordFacts(records: Records, number: number, header: SceneHeader): [string, string][] {
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
    ['Noise', `${digits(100 * at(49))} %`],
  ];
}

function digits(x: number): string {
  return Number(x.toPrecision(4)).toString();
}
