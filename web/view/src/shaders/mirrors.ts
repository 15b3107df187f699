// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Adds what surfaces mirror where no record of radiance serves: from the picture of a mirrored eye where they lie in one of its
// planes, otherwise from what the picture itself shows along the mirrored direction, otherwise from the sky. All of this is an
// approximation, which an overlay marks. The same pass draws glass over the picture: what is behind it, without refraction, and what
// its faces mirror.

import { unpacking } from './records';

export const mirrorsFragment = /* glsl */ `#version 300 es
precision highp float;
precision highp int;
layout(location = 0) out vec4 outRadiance;  // w: 1 where something is approximated, 2 where glass is
uniform highp sampler2D positions, normals, sums, glossSums, picture;
uniform highp sampler2D mirrorPositions, mirrorNormals, mirrorAlbedos, mirrorRadiances;  // of what mirrors: the same surfaces, or glass
uniform highp sampler2D alphas;  // of materials, by their number
uniform highp sampler2D mirror0, mirror1, sky;
uniform vec4 plane0, plane1;     // normal and offset
uniform int planes;
uniform bool hasSky, showIndirect, glass;
uniform mat3 skyFromWorld;
uniform mat4 viewProjection;
uniform vec4 eye;
uniform vec2 size;
uniform float diagonal, pixelAngle;  // of the scene, m; width of a pixel at distance 1
const float pi = 3.14159265358979;
${unpacking}
vec3 reflectance(float packed) {
  vec3 root = vec3(mod(packed, 256.0), mod(floor(packed / 256.0), 256.0), floor(packed / 65536.0)) / 255.0;
  return root * root;
}
bool lies(vec4 plane, vec3 p, vec3 n) {
  return dot(plane.xyz, n) > 0.999 && abs(dot(plane.xyz, p) - plane.w) < 2e-4 * diagonal;
}
vec3 skyTowards(vec3 direction) {
  vec3 d = skyFromWorld * direction;
  return texture(sky, vec2(0.5 + atan(d.x, -d.z) / (2.0 * pi), acos(clamp(d.y, -1.0, 1.0)) / pi)).rgb;
}
// What the picture shows where a ray from p meets a surface that it shows; w is 0 where it meets none.
vec4 alongRay(vec3 p, vec3 direction) {
  float t = 2e-3 * diagonal, before = 0.0;
  for (int i = 0; i < 40; ++i, before = t, t *= 1.16) {
    vec4 clip = viewProjection * vec4(p + t * direction, 1.0);
    if (clip.w <= 0.0) break;
    vec2 at = (clip.xy / clip.w * 0.5 + 0.5) * size;
    if (any(lessThan(at, vec2(0.0))) || any(greaterThanEqual(at, size))) break;
    vec4 shown = texelFetch(positions, ivec2(at), 0);
    if (shown.w < 0.5) continue;
    float behind = distance(p + t * direction, eye.xyz) - distance(shown.xyz, eye.xyz);
    if (behind <= 0.0 || behind > 2.0 * (t - before) + 1e-3 * diagonal) continue;
    // Only what faces the ray is met from its front.
    if (dot(texelFetch(normals, ivec2(at), 0).xyz, direction) > 0.0) continue;
    return vec4(texelFetch(picture, ivec2(at), 0).rgb, 1.0);
  }
  return vec4(0.0);
}
void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 before = texelFetch(picture, pixel, 0);
  vec3 base = before.rgb;
  outRadiance = vec4(base, glass ? before.w : 0.0);
  vec4 at = texelFetch(mirrorPositions, pixel, 0), normal = texelFetch(mirrorNormals, pixel, 0);
  if (!showIndirect || at.w < 0.5 || normal.w < 0.5) return;
  vec3 share = reflectance(texelFetch(mirrorRadiances, pixel, 0).w);
  if (glass) {
    // Glass behind a surface is not seen.
    vec4 shown = texelFetch(positions, pixel, 0);
    vec3 forth = eye.w > 0.5 ? at.xyz - eye.xyz : -eye.xyz;
    if (shown.w > 0.5 && dot(shown.xyz - at.xyz, forth) < 0.0) return;
    base *= texelFetch(mirrorAlbedos, pixel, 0).rgb * (1.0 - share);
    outRadiance = vec4(base, 2.0);
  } else if (texelFetch(glossSums, pixel, 0).w > 0.0) {
    return;
  }
  if (share.r + share.g + share.b <= 0.0) return;
  float alpha = texelFetch(alphas, ivec2(int(at.w + 0.5) - 1, 0), 0).r;
  float packed = texelFetch(mirrorAlbedos, pixel, 0).w;
  vec3 s = packed < 0.0 ? normal.xyz : unpacked(packed);
  vec3 towards = normalize(eye.xyz - eye.w * at.xyz);
  vec3 mirrored = reflect(-towards, s);
  // A rough mirror is a blurred one: what it shows is about as far behind it as the eye is in front.
  float blur = max(0.0, log2(max(1.0, 0.5 * alpha / pixelAngle)));
  vec2 place = gl_FragCoord.xy / size;
  vec4 sum = glass ? vec4(0.0) : texelFetch(sums, pixel, 0);
  vec4 found;
  bool even = packed < 0.0 || dot(s, normal.xyz) > 0.9999;
  if (planes > 0 && even && lies(plane0, at.xyz, normal.xyz)) found = vec4(textureLod(mirror0, place, blur).rgb, 1.0);
  else if (planes > 1 && even && lies(plane1, at.xyz, normal.xyz)) found = vec4(textureLod(mirror1, place, blur).rgb, 1.0);
  else found = eye.w > 0.5 ? alongRay(at.xyz, mirrored) : vec4(0.0);
  // The mean of all light that falls on the surface stands in for what no picture shows, and for wide lobes.
  vec3 mean = sum.w > 0.0 ? sum.rgb / sum.w / pi : vec3(0.0);
  vec3 light = found.w > 0.0 ? found.rgb : hasSky ? skyTowards(mirrored) : mean;
  if (sum.w > 0.0) light = mix(light, mean, smoothstep(0.25, 0.6, alpha));
  outRadiance = vec4(base + share * light, glass ? 2.0 : 1.0);
}
`;
