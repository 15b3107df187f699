// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Records of radiance: each becomes a small image of what its surface reflects towards the directions of a grid, and a splat
// reads that image (python/eclat/viewer/gloss.py, core/records/radiance_record_cache.cpp).

import { fetching, reading, unpacking } from './records';

/** Images of records side by side in the atlas. */
export const TILES_A_ROW = 64;

/** Multiplies the coefficients of each of some records with the factors of its lobe, up to an order. */
export const prefilterFragment = /* glsl */ `#version 300 es
precision highp float;
precision highp int;
layout(location = 0) out vec4 outValue;   // radiance, with the excess; the width of the lobe
layout(location = 1) out vec4 outAlongU;  // derivatives along u and v of the frame around the normal
layout(location = 2) out vec4 outAlongV;
uniform highp sampler2D coefficients, lobes;
uniform float lightScale;  // of the light in images and sums, so that half floats hold them
uniform int first, count, order2, shownOrder2, grid, recordsARow;  // of the records whose coefficients these are
${fetching}
void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy), tile = pixel / grid, at = pixel % grid;
  int record = tile.y * ${TILES_A_ROW} + tile.x;
  if (record < first || record >= first + count) discard;
  int row = (int(recordTexel(record, 12).y) * grid + at.y) * grid + at.x;
  int number = record - first;
  ivec2 from = ivec2((number % recordsARow) * 3 * order2, number / recordsARow);
  vec3 value = vec3(0.0), alongU = vec3(0.0), alongV = vec3(0.0);
  for (int i = 0; i < shownOrder2; ++i) {
    vec3 factor = texelFetch(lobes, ivec2(i, row), 0).rgb;
    value += factor * texelFetch(coefficients, from + ivec2(i, 0), 0).rgb;
    alongU += factor * texelFetch(coefficients, from + ivec2(order2 + i, 0), 0).rgb;
    alongV += factor * texelFetch(coefficients, from + ivec2(2 * order2 + i, 0), 0).rgb;
  }
  vec4 lobe = texelFetch(lobes, ivec2(order2, row), 0);
  vec3 excess = vec3(recordTexel(record, 3).w, recordTexel(record, 4).xy);
  outValue = vec4(lightScale * (value + lobe.rgb * excess / 3.14159265358979), lobe.a);
  outAlongU = vec4(lightScale * alongU, 0.0);
  outAlongV = vec4(lightScale * alongV, 0.0);
}
`;

export const glossFragment = /* glsl */ `#version 300 es
precision highp float;
precision highp int;
flat in int vRecord;
layout(location = 0) out vec4 weighted;
uniform highp sampler2D positions, normals, albedos;
uniform highp sampler2D values, alongU, alongV;
uniform vec4 eye;
uniform int grid;
${fetching}
${reading}
${unpacking}
const float cosLargestTilt = 0.955336489;  // of the core's largest_radiance_tilt
void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 at = texelFetch(positions, pixel, 0), normal = texelFetch(normals, pixel, 0);
  if (at.w < 0.5 || normal.w < 0.5) discard;
  vec4 t0 = recordTexel(vRecord, 0), t1 = recordTexel(vRecord, 1);
  vec3 d = at.xyz - t0.xyz, n = normal.xyz, recordNormal = t1.xyz;
  vec3 stretch = recordTexel(vRecord, 2).xyz;
  float radius = radiusOf(vRecord, t0);
  if (weightAt(radius, d, n, recordNormal, stretch, relaxation) <= 0.0) discard;
  float packed = texelFetch(albedos, pixel, 0).w;
  vec3 s = packed < 0.0 ? n : unpacked(packed);
  if (dot(s, recordNormal) < cosLargestTilt || dot(s, n) < cosLargestTilt) discard;
  // Where the normals differ, the direction is turned so that the mirrored one stays.
  vec3 towards = normalize(eye.xyz - eye.w * at.xyz);
  vec3 mirrored = reflect(-towards, s);
  vec3 turned = 2.0 * dot(recordNormal, mirrored) * recordNormal - mirrored;
  float signZ = signZOf(vRecord);
  float a = -1.0 / (signZ + recordNormal.z), b = recordNormal.x * recordNormal.y * a;
  vec3 u = vec3(1.0 + signZ * recordNormal.x * recordNormal.x * a, signZ * b, -signZ * recordNormal.x);
  vec3 v = vec3(b, signZ + recordNormal.y * recordNormal.y * a, -recordNormal.y);
  vec3 local = vec3(dot(turned, u), dot(turned, v), max(dot(turned, recordNormal), 0.0));
  vec2 place = local.xy / (1.0 + local.z) * 0.5 + 0.5;
  ivec2 tile = ivec2(vRecord % ${TILES_A_ROW}, vRecord / ${TILES_A_ROW});
  vec2 texel = (vec2(tile * grid) + 0.5 + place * float(grid - 1)) / vec2(textureSize(values, 0));
  vec4 value = textureLod(values, texel, 0.0);
  if (value.w <= 0.0) discard;
  float w = weightAt(radius, d, n, recordNormal, stretch, relaxation * clamp(value.w, 0.25, 1.0));
  if (w <= 0.0 || outOfSight(vRecord, recordNormal, t1.w, d)) discard;
  vec3 radiance = value.rgb;
  if (translationGradient) {
    radiance += dot(d, u) * textureLod(alongU, texel, 0.0).rgb + dot(d, v) * textureLod(alongV, texel, 0.0).rgb;
  }
  weighted = vec4(w * clamp(radiance, vec3(0.0), 2.0 * abs(value.rgb)), w);
}
`;
