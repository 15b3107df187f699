// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// What the picture shows, as the panel chooses it.

import type { Weighting } from './records';

export type ToneMapping = 'none' | 'filmic' | 'agx';
export type Overlay = 'none' | 'weights' | 'density' | 'left-out' | 'records' | 'clearance' | 'noise' | 'error' | 'lobes';

/** What the picture shows. */
export interface Look {
  exposure: number;
  toneMapping: ToneMapping;
  overlay: Overlay;
  direct: boolean;
  indirect: boolean;
  gradients: boolean;
  clearance: boolean;
  /** Whether radii are bounded by those of neighbours. */
  clamping: boolean;
  weight: Weighting;
  /** The greatest order of harmonics of radiance that is read, at most that of the records. */
  order: number;
  /** Whether mirrors, and gloss without records, are shown by approximations. */
  mirrors: boolean;
  /** Where the picture of the server begins beside that of the page, as a share of the width from the left. */
  wipe: number;
  /** Whether the difference of both is shown instead of them. */
  difference: boolean;
}

export const USUAL_LOOK: Look = {
  exposure: 0,
  toneMapping: 'none',
  overlay: 'none',
  direct: true,
  indirect: true,
  gradients: true,
  clearance: true,
  clamping: true,
  weight: 'solved',
  order: Infinity,
  mirrors: true,
  wipe: 0.5,
  difference: false,
};

/** The numbers of these in shaders/display.ts. */
export const TONE_MAPPINGS: Record<ToneMapping, number> = { none: 0, filmic: 1, agx: 2 };
export const OVERLAYS: Record<Overlay, number> = { none: 0, weights: 1, density: 2, 'left-out': 3, records: 4, clearance: 5, noise: 6, lobes: 7, error: 8 };
