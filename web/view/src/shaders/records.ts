// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Records of irradiance in shaders: their rows (python/eclat/viewer/record_rows.py), their weight (core/records/weight.h) and
// what they extrapolate to a point (core/records/record_cache.cpp). The formulas are those of the core, term by term, so
// that the page shows what `eclat render` shows; docs/guides/view.md explains them.

/** Texels of a record. */
export const TEXELS = 13;

/** Records side by side in a row of the texture. */
export const RECORDS_A_ROW = 128;

/** The luminance of a colour is its product with this vector of a shader. */
export const LUMINANCE = 'vec3(0.2126, 0.7152, 0.0722)';

export const fetching = /* glsl */ `
uniform highp sampler2D records;

vec4 recordTexel(int record, int texel) {
  return texelFetch(records, ivec2((record % ${RECORDS_A_ROW}) * ${TEXELS} + texel, record / ${RECORDS_A_ROW}), 0);
}
`;

export const reading = /* glsl */ `
uniform int weightKind;  // 0: Tabellion, 1: Ward, 2: split-sphere
uniform float relaxation, tolerance;
uniform bool rotationGradient, translationGradient, clearanceTest, neighborClamping;

const float sqrtOneMinusCos10 = 0.12326, largestTurn = 1.146, planeTolerance = 0.015;
const float pi = 3.14159265358979;

// The radius of a record, with or without the bounds by its neighbours, of its first texel.
float radiusOf(int record, vec4 t0) { return neighborClamping ? t0.w : abs(recordTexel(record, 12).z); }
// The sign of the z of its normal, for −0.
float signZOf(int record) { return sign(recordTexel(record, 12).z); }
// The core's safe_sqrt.
float safeSqrt(float x) { return sqrt(max(x, 0.0)); }

float splitSphereWeight(float radius, vec3 d, vec3 n, vec3 recordNormal, float relaxed) {
  float e = (length(d) / radius + safeSqrt(1.0 - dot(n, recordNormal)) / tolerance) / relaxed;
  if (e >= 1.0 || dot(d, n + recordNormal) < -1e-3 * radius) return 0.0;
  return 1.0 / max(e, 1e-3) - 1.0;
}

// The weight of a record at a point with the normal n, which is off by d from the record. The factor relaxed says how much farther than
// its radius the record is read.
float weightAt(float radius, vec3 d, vec3 n, vec3 recordNormal, vec3 stretch, float relaxed) {
  if (weightKind == 2) return splitSphereWeight(radius, d, n, recordNormal, relaxed);
  float cosine = dot(n, recordNormal);
  float tolerated = sqrtOneMinusCos10 * min(relaxed, largestTurn);
  float reach = radius * relaxed;
  float along = dot(d, stretch);
  float distance2 = dot(d, d) - along * along;
  if (1.0 - cosine >= tolerated * tolerated || distance2 >= reach * reach) return 0.0;
  float ePosition = sqrt(max(0.0, distance2)) / reach;
  float turn = safeSqrt(1.0 - cosine);
  float facets = sqrt(dot(d, d) * max(0.0, 1.0 - cosine * cosine));
  float offset = 0.5 * (abs(dot(d, n + recordNormal)) - facets);
  float offPlane = max(0.0, offset) / (planeTolerance * radius);
  if (weightKind == 0) {
    float e = max(max(ePosition, offPlane), turn / tolerated);
    return e < 1.0 ? (1.0 - e) * (1.0 - e) : 0.0;
  }
  float e = ePosition + turn / tolerated;
  return e < 1.0 && offPlane < 1.0 ? (1.0 / max(e, 1e-3) - 1.0) * (1.0 - offPlane) : 0.0;
}

// The sector of azimuth of d around the normal, as clearance_sector of core/hemisphere/hemisphere.cpp counts them.
int thirdOf(float along, float across) {
  const float tan30 = 0.57735027;
  return across < tan30 * along ? 0 : tan30 * across < along ? 1 : 2;
}
int sectorOf(vec3 n, float signZ, vec3 d) {
  float a = -1.0 / (signZ + n.z), b = n.x * n.y * a;
  float u = dot(d, vec3(1.0 + signZ * n.x * n.x * a, signZ * b, -signZ * n.x));
  float v = dot(d, vec3(b, signZ + n.y * n.y * a, -n.y));
  if (v < 0.0) return u < 0.0 ? thirdOf(-u, -v) : 3 + thirdOf(-v, u);
  return u > 0.0 ? 6 + thirdOf(u, v) : 9 + thirdOf(v, -u);
}

// Whether geometry lies between the record and the point.
bool outOfSight(int record, vec3 n, float leastClearance, vec3 d) {
  if (weightKind == 2 || !clearanceTest || dot(d, d) <= leastClearance * leastClearance) return false;
  int sector = sectorOf(n, signZOf(record), d);
  float clearance = recordTexel(record, 9 + sector / 4)[sector % 4];
  return dot(d, d) > clearance * clearance;
}

float bounded(float value, float bent) { return clamp(bent, 0.05 * value, 20.0 * value); }

// The share of a uniform hemisphere's light that a shading normal s leaves where n is the geometric one.
float evenShare(vec3 n, vec3 s) { return s != n ? 0.5 * (1.0 + clamp(dot(n, s), -1.0, 1.0)) : 1.0; }

// What the translation gradients of a record add along d.
vec3 alongGradients(int record, vec3 d) {
  if (!translationGradient) return vec3(0.0);
  vec4 t4 = recordTexel(record, 4), t8 = recordTexel(record, 8);
  vec3 first = vec3(recordTexel(record, 5).w, recordTexel(record, 6).w, recordTexel(record, 7).w);
  return vec3(dot(d, first), dot(d, t8.xyz), dot(d, vec3(t8.w, t4.zw)));
}

// The irradiance that a record gives at d with the geometric normal n and the shading normal s.
vec3 extrapolated(int record, vec3 d, vec3 n, vec3 s, vec3 recordNormal) {
  vec4 t3 = recordTexel(record, 3), t4 = recordTexel(record, 4);
  bool bends = s != n;
  float even = evenShare(n, s);
  vec3 value = t3.rgb, bent = (value + alongGradients(record, d)) * even;
  if (rotationGradient) {
    vec3 turn = cross(recordNormal, n) * even;
    if (bends) turn += cross(n, s) * (1.0 - acos(clamp(dot(n, s), -1.0, 1.0)) / pi);
    vec3 r = recordTexel(record, 5).xyz, g = recordTexel(record, 6).xyz, b = recordTexel(record, 7).xyz;
    bent += vec3(dot(turn, r), dot(turn, g), dot(turn, b));
  }
  vec3 E = vec3(bounded(value.r, bent.r), bounded(value.g, bent.g), bounded(value.b, bent.b));
  return E + vec3(t3.w, t4.xy) * even;
}
`;

/** The shading normal that shaders/surfaces.ts packs. */
export const unpacking = /* glsl */ `
vec3 unpacked(float packed) {
  float y = floor(packed / 4096.0);
  vec2 f = vec2(packed - 4096.0 * y, y) / 4095.0 * 2.0 - 1.0;
  vec3 n = vec3(f, 1.0 - abs(f.x) - abs(f.y));
  float t = max(-n.z, 0.0);
  n.xy += vec2(n.x >= 0.0 ? -t : t, n.y >= 0.0 ? -t : t);
  return normalize(n);
}
`;
