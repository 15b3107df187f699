// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Where a picture lacks records.

import * as three from 'three';

/** The kind of gloss of rough surfaces in the image of normals. */
const ROUGH = 1;

/** Lobes of this roughness α, seen at this cosine at least, can be held by harmonics of order 8 (docs/algorithms/radiance_cache.md). */
const ROUGH_ENOUGH = 0.35;
const STEEP_ENOUGH = 0.35;

/** Images of a picture, four numbers a pixel: those of the geometry pass, and sums of splats. */
export interface Images {
  readonly positions: Float32Array;
  readonly normals: Float32Array;
  readonly albedos: Float32Array;
  readonly sums: Float32Array;
  readonly glossSums: Float32Array;
}

/**
 * Returns the share of the pixels whose surfaces lack records: matte ones, and, if there are records of radiance, those whose gloss
 * these may hold. `roughness` is that of a material, and `eye` as Pose says.
 */
export function shareWithoutRecords(
  { positions, normals, albedos, sums, glossSums }: Images,
  eye: three.Vector4,
  radiance: boolean,
  roughness: (material: number) => number,
): number {
  const [away, place, normal] = [new three.Vector3(), new three.Vector3(), new three.Vector3()];
  const lacks = (i: number) => {
    const matte = Math.max(albedos[i] ?? 0, albedos[i + 1] ?? 0, albedos[i + 2] ?? 0) > 0;
    if (matte && !((sums[i + 3] ?? 0) > 0)) return true;
    if (!radiance || normals[i + 3] !== ROUGH || (glossSums[i + 3] ?? 0) > 0) return false;
    if (!(roughness((positions[i + 3] ?? 0) - 1) >= ROUGH_ENOUGH)) return false;
    away.set(eye.x, eye.y, eye.z).addScaledVector(place.fromArray(positions, i), -eye.w).normalize();
    return away.dot(normal.fromArray(normals, i)) >= STEEP_ENOUGH;
  };
  let missing = 0;
  for (let i = 0; i < albedos.length; i += 4) if (lacks(i)) ++missing;
  return missing / (albedos.length / 4);
}
