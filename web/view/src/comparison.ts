// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// How far one picture of the page is from the picture that the server renders of the same view: the relative error of
// python/eclat/measure/metrics.py, of the whole picture and away from edges.

/** The constant c of the error, in units of the mean of the squared truth, and what counts as an edge: as in metrics.py. */
const RELATIVE_C = 0.01;
const COS_EDGE = Math.cos((10 * Math.PI) / 180);
const EDGE_DEPTH = 0.02;

/** A picture as two of half the samples each, (height, width, 3), row 0 at the top. */
export interface Halves {
  readonly width: number;
  readonly height: number;
  readonly first: Float32Array;
  readonly second: Float32Array;
}

/** Relative RMSE, 0.01 is 1 %. */
export interface Figures {
  readonly whole: number;
  /** Nothing where the picture is edges only. */
  readonly away: number | undefined;
}

/** Computes c, which keeps errors of black places finite. */
export function floorOf(truth: Halves): number {
  let sum = 0;
  truth.first.forEach((a, i) => (sum += (0.5 * (a + (truth.second[i] ?? 0))) ** 2));
  return (RELATIVE_C * sum) / truth.first.length;
}

/**
 * Compares a picture (height, width, 4), the first row at the bottom, with the truth. The noise of the two halves cancels
 * from the mean of (x − a)(x − b). `away` has a number for each pixel of the picture, nonzero away from edges.
 */
export function compared(picture: Float32Array, truth: Halves, away: Uint8Array): Figures {
  const { width, height, first, second } = truth;
  const c = floorOf(truth);
  let [whole, smooth, counted] = [0, 0, 0];
  for (let y = 0; y < height; ++y) {
    for (let x = 0; x < width; ++x) {
      const [at, from] = [y * width + x, (height - 1 - y) * width + x];
      let squares = 0;
      for (let channel = 0; channel < 3; ++channel) {
        const value = picture[4 * from + channel] ?? 0;
        const [a, b] = [first[3 * at + channel] ?? 0, second[3 * at + channel] ?? 0];
        const scale = (0.5 * (a + b)) ** 2 + c;
        if (scale > 0) squares += ((value - a) * (value - b)) / scale;
      }
      whole += squares;
      if (away[from]) {
        smooth += squares;
        ++counted;
      }
    }
  }
  const error = (sum: number, pixels: number) => Math.sqrt(Math.max(0, sum / (3 * pixels)));
  return { whole: error(whole, width * height), away: counted > 0 ? error(smooth, counted) : undefined };
}

/**
 * Returns 1 for pixels with no edge within two pixels horizontally and vertically, otherwise 0: neighbours whose normals or
 * depths differ, or of which only one shows a surface. `positions` and `normals` are (height, width, 4) of the geometry
 * pass; `eye` is a position and 1, or a direction and 0.
 */
export function awayFromEdges(
  positions: Float32Array,
  normals: Float32Array,
  eye: readonly number[],
  width: number,
  height: number,
): Uint8Array {
  const [ex = 0, ey = 0, ez = 0, near = 1] = eye;
  const depth = new Float32Array(width * height);
  for (let i = 0; i < depth.length; ++i) {
    const [x = 0, y = 0, z = 0, seen = 0] = positions.subarray(4 * i, 4 * i + 4);
    if (seen < 0.5) continue;
    depth[i] = near > 0.5 ? Math.hypot(x - ex, y - ey, z - ez) : FAR_AWAY - (x * ex + y * ey + z * ez);
  }
  const differ = (i: number, j: number) => {
    const [a, b] = [depth[i] ?? 0, depth[j] ?? 0];
    if ((a > 0) !== (b > 0)) return true;
    if (a === 0) return false;
    let cosine = 0;
    for (let k = 0; k < 3; ++k) cosine += (normals[4 * i + k] ?? 0) * (normals[4 * j + k] ?? 0);
    return cosine < COS_EDGE || Math.abs(a - b) > EDGE_DEPTH * Math.min(a, b);
  };
  const edge = new Uint8Array(width * height);
  for (let y = 0; y < height; ++y) {
    for (let x = 0; x < width; ++x) {
      const i = y * width + x;
      for (const [dx, dy] of [[1, 0], [0, 1], [1, 1], [-1, 1]] as const) {
        if (x + dx < 0 || x + dx >= width || y + dy >= height) continue;
        const j = i + dy * width + dx;
        if (differ(i, j)) edge[i] = edge[j] = 1;
      }
    }
  }
  return edge.map((_, i) => (nearEdge(edge, i % width, Math.floor(i / width), width, height) ? 0 : 1));
}

/** Depths of a parallel view are counted from so far behind the scene, in metres, that none is negative. */
const FAR_AWAY = 1e6;

function nearEdge(edge: Uint8Array, x: number, y: number, width: number, height: number): boolean {
  for (let v = Math.max(0, y - 1); v <= Math.min(height - 1, y + 1); ++v) {
    for (let u = Math.max(0, x - 1); u <= Math.min(width - 1, x + 1); ++u) if (edge[v * width + u]) return true;
  }
  return false;
}
