// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The planes of surfaces that mirror. The picture of what lies behind such a plane, seen by the mirrored eye, is what it reflects.

import * as three from 'three';
import type { Pose } from './pose';

/** Planes in a picture, each of which costs another picture. */
export const MOST_PLANES = 2;

/** Candidates that are kept, of the largest area. */
const KEPT = 64;

/** A plane n · x = offset, and how much of the scene lies in it. */
export interface Plane {
  readonly normal: three.Vector3;
  readonly offset: number;
  readonly area: number;
  readonly middle: three.Vector3;
}

interface Sum {
  readonly normal: three.Vector3;
  offset: number;
  area: number;
  readonly middle: three.Vector3;
}

/** Collects the planes of triangles. */
export class Planes {
  private readonly sums = new Map<string, Sum>();

  constructor(private readonly diagonal: number) {}

  /** Adds the triangles (corners in order, 9 numbers each), and their other sides where these reflect, too. */
  add(positions: Float32Array, twoSided: boolean): void {
    const [a, b, c] = [new three.Vector3(), new three.Vector3(), new three.Vector3()];
    for (let i = 0; i + 9 <= positions.length; i += 9) {
      a.fromArray(positions, i);
      b.fromArray(positions, i + 3);
      c.fromArray(positions, i + 6);
      const middle = a.clone().add(b).add(c).divideScalar(3);
      const normal = b.sub(a).cross(c.sub(a));
      const area = 0.5 * normal.length();
      if (!(area > 0)) continue;
      normal.normalize();
      this.count(normal, middle, area);
      if (twoSided) this.count(normal.clone().negate(), middle, area);
    }
  }

  /** The planes of the largest area. */
  largest(): Plane[] {
    return [...this.sums.values()]
      .map(({ normal, offset, area, middle }) => ({
        normal: normal.clone().normalize(),
        offset: offset / area,
        area,
        middle: middle.clone().divideScalar(area),
      }))
      .sort((a, b) => b.area - a.area)
      .slice(0, KEPT);
  }

  private count(normal: three.Vector3, middle: three.Vector3, area: number): void {
    const offset = normal.dot(middle);
    const key = [...normal.toArray().map((x) => Math.round(200 * x) + 0), Math.round((1e3 * offset) / this.diagonal)].join();
    let sum = this.sums.get(key);
    if (!sum) this.sums.set(key, (sum = { normal: new three.Vector3(), offset: 0, area: 0, middle: new three.Vector3() }));
    sum.normal.addScaledVector(normal, area);
    sum.middle.addScaledVector(middle, area);
    sum.offset += area * offset;
    sum.area += area;
  }
}

/** Returns the planes that take the most of a view, roughly: by area over squared distance, of those that face the eye. */
export function chosenPlanes(planes: readonly Plane[], pose: Pose): Plane[] {
  if (pose.orthographic) return [];
  const eye = pose.position;
  const seen = planes.map((plane) => {
    const away = eye.clone().sub(plane.middle);
    const height = plane.normal.dot(eye) - plane.offset;
    const distance2 = Math.max(away.lengthSq(), 1e-2 * plane.area);
    return { plane, share: height > 1e-5 * pose.diagonal ? (plane.area * height) / distance2 ** 1.5 : 0 };
  });
  return seen
    .filter(({ share }) => share > 1e-3)
    .sort((a, b) => b.share - a.share)
    .slice(0, MOST_PLANES)
    .map(({ plane }) => plane);
}

/** The reflection at a plane. */
export function reflection({ normal: n, offset }: Plane): three.Matrix4 {
  const [x, y, z] = n.toArray();
  // Row by row: 1 − 2 n nᵀ, and 2 · offset · n.
  return new three.Matrix4().set(
    1 - 2 * x * x, -2 * x * y, -2 * x * z, 2 * offset * x,
    -2 * x * y, 1 - 2 * y * y, -2 * y * z, 2 * offset * y,
    -2 * x * z, -2 * y * z, 1 - 2 * z * z, 2 * offset * z,
    0, 0, 0, 1,
  );
}
