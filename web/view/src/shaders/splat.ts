// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// A record as a splat: a box around all that it may serve. Its far sides are drawn, and only where they lie behind the surface
// that is seen; so the box is found from inside as well, and what is far in front of a box costs nothing. Each fragment
// adds (w E, w), and a later pass divides the sums. As in core/records/record_cache.cpp, half of the covariance of gradients and
// ways from the records is taken away from the quotient: a first pass adds (w d, w) for the mean way, and the second also adds
// what gradients change beside it, which a pass over the picture subtracts (`unbendFragment`).

import { fetching, LUMINANCE, reading, unpacking } from './records';

export const splatVertex = /* glsl */ `#version 300 es
precision highp float;
precision highp int;
in vec3 position;
uniform mat4 viewProjection;
uniform int weightKind;
uniform float relaxation;
uniform bool neighborClamping;
flat out int vRecord;
${fetching}
void main() {
  vRecord = gl_InstanceID;
  vec4 t0 = recordTexel(vRecord, 0);
  vec3 n = recordTexel(vRecord, 1).xyz;
  vec4 t2 = recordTexel(vRecord, 2);
  // As radiusOf of shaders/records.ts.
  float radius = neighborClamping ? t0.w : abs(recordTexel(vRecord, 12).z);
  float reach = radius * relaxation, far = reach * t2.w;
  // As height_read of core/records/weight.h says.
  float height = weightKind == 2 ? far : 0.015 * radius + 0.2 * far;
  float stretch2 = dot(t2.xyz, t2.xyz);
  vec3 other = abs(n.z) < 0.9 ? vec3(0.0, 0.0, 1.0) : vec3(1.0, 0.0, 0.0);
  vec3 u = stretch2 > 1e-12 ? t2.xyz * inversesqrt(stretch2) : normalize(cross(other, n));
  vec3 v = cross(n, u);
  vec3 corner = t0.xyz + u * (far * position.x) + v * (reach * position.y) + n * (height * position.z);
  gl_Position = viewProjection * vec4(corner, 1.0);
}
`;

/** Draws every record over the whole picture, to compare with the core at given points. */
export const everywhereVertex = /* glsl */ `#version 300 es
in vec3 position;
flat out highp int vRecord;
void main() {
  vRecord = gl_InstanceID;
  gl_Position = vec4(position.xy, 0.0, 1.0);
}
`;

export const splatFragment = /* glsl */ `#version 300 es
precision highp float;
precision highp int;
flat in int vRecord;
layout(location = 0) out vec4 weighted;
layout(location = 1) out vec4 bending;  // only where light is added
uniform highp sampler2D positions, normals, albedos, ways;
uniform int overlay;  // instead of irradiance 1: the number of splats, 2: ellipses of the radii and places of records, 3: the number of fragments,
                      // 4: the distance to the nearest obstacle, 5: the relative noise of the record, 6: the way from the record,
                      // 7: the error of extrapolation, and the variance of its noise
uniform vec4 eye;
uniform float pixelAngle;  // width of a pixel at distance 1, or of a parallel view
uniform float lightScale;  // of the light in sums, so that half floats hold them
${fetching}
${reading}
${unpacking}
const vec3 luminance = ${LUMINANCE};
void main() {
  bending = vec4(0.0);
  if (overlay == 3) {
    weighted = vec4(1.0, 0.0, 0.0, 0.0);
    return;
  }
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 at = texelFetch(positions, pixel, 0);
  if (at.w < 0.5) discard;
  vec4 t0 = recordTexel(vRecord, 0), t1 = recordTexel(vRecord, 1);
  vec3 d = at.xyz - t0.xyz;
  vec3 n = texelFetch(normals, pixel, 0).xyz;
  float radius = radiusOf(vRecord, t0);
  float w = weightAt(radius, d, n, t1.xyz, recordTexel(vRecord, 2).xyz, relaxation);
  if (w <= 0.0 || outOfSight(vRecord, t1.xyz, t1.w, d)) discard;
  if (overlay == 1) {
    weighted = vec4(1.0, 0.0, 0.0, w);
    return;
  }
  if (overlay == 2) {
    float along = dot(d, recordTexel(vRecord, 2).xyz);
    float pixelWidth = pixelAngle * (eye.w > 0.5 ? distance(eye.xyz, at.xyz) : 1.0);
    float ring = abs(sqrt(max(0.0, dot(d, d) - along * along)) - radius) / pixelWidth;
    weighted = vec4(1.0 - smoothstep(0.5, 1.5, ring), 1.0 - smoothstep(1.5, 2.5, length(d) / pixelWidth), 0.0, w);
    return;
  }
  if (overlay == 6) {
    weighted = vec4(w * d, w);
    return;
  }
  if (overlay == 7) {
    vec4 t3 = recordTexel(vRecord, 3), t12 = recordTexel(vRecord, 12);
    float along = dot(d, recordTexel(vRecord, 2).xyz), distance2 = max(dot(d, d) - along * along, 0.0);
    float noise = w * t12.y * dot(t3.rgb + vec3(t3.w, recordTexel(vRecord, 4).xy), luminance);
    noise *= lightScale;
    weighted = vec4(w * 0.5 * t12.w * distance2 * lightScale, noise * noise, 0.0, w);
    return;
  }
  if (overlay >= 4) {
    weighted = vec4(w * (overlay == 4 ? t1.w : recordTexel(vRecord, 12).y), 0.0, 0.0, w);
    return;
  }
  float packed = texelFetch(albedos, pixel, 0).w;
  vec3 s = packed < 0.0 ? n : unpacked(packed);
  weighted = vec4(w * lightScale * extrapolated(vRecord, d, n, s, t1.xyz), w);
  vec4 way = texelFetch(ways, pixel, 0);
  bending = vec4(w * lightScale * evenShare(n, s) * alongGradients(vRecord, d - way.xyz / way.w), 0.0);
}
`;

/** Subtracts half of the covariance of gradients and ways from the sums of splats, which are of light as it is then. */
export const unbendFragment = /* glsl */ `#version 300 es
precision highp float;
layout(location = 0) out vec4 weighted;
uniform highp sampler2D firstOrder, bendings;
uniform float lightScale;
void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 sum = texelFetch(firstOrder, pixel, 0);
  vec3 E = sum.rgb - 0.5 * texelFetch(bendings, pixel, 0).rgb;
  weighted = vec4(clamp(E, 0.05 * sum.rgb, 20.0 * sum.rgb) / lightScale, sum.w);
}
`;

/** Makes estimated errors, relative to what is read, of the sums that splats add for them (core/records/estimated_error.cpp). */
export const errorFragment = /* glsl */ `#version 300 es
precision highp float;
layout(location = 0) out vec4 outError;
uniform highp sampler2D counts, sums;
uniform float meanLuminance, lightScale;  // of all records; of the light in counts
void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 parts = texelFetch(counts, pixel, 0), sum = texelFetch(sums, pixel, 0);
  if (parts.w <= 0.0 || sum.w <= 0.0) discard;
  float light = dot(sum.rgb, ${LUMINANCE}) / sum.w, judged = sqrt(light * light + 0.01 * meanLuminance * meanLuminance);
  outError = vec4(judged > 0.0 ? sqrt(parts.x * parts.x + parts.y) / (parts.w * judged * lightScale) : 0.0, 0.0, 0.0, 1.0);
}
`;
