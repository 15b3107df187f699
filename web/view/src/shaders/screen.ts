// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Passes over the whole picture: the light of a lamp, the division of the sums of splats, and the display.

export const screenVertex = /* glsl */ `#version 300 es
in vec3 position;
void main() { gl_Position = vec4(position.xy, 0.0, 1.0); }
`;

/** Adds the light of a lamp that diffuse surfaces reflect. */
export const lampFragment = /* glsl */ `#version 300 es
precision highp float;
precision highp int;
layout(location = 0) out vec4 outRadiance;
uniform highp sampler2D positions, normals, albedos;
uniform highp samplerCube cube;
uniform highp sampler2D flatMap;
uniform int kind;  // 0: point or spot, 1: sun
uniform vec3 lampPosition, lampDirection, power;
uniform float cosInner, cosOuter, innerAngle, outerAngle;
uniform int falloff;  // 0: none, 1: smooth, 2: linear
uniform mat4 toMap;   // of a sun
uniform float texel;  // of the map: m for a sun, m at the distance of 1 m for other lamps
const float pi = 3.14159265358979;

vec3 unpacked(float packed) {
  float y = floor(packed / 4096.0);
  vec2 f = vec2(packed - 4096.0 * y, y) / 4095.0 * 2.0 - 1.0;
  vec3 n = vec3(f, 1.0 - abs(f.x) - abs(f.y));
  float t = max(-n.z, 0.0);
  n.xy += vec2(n.x >= 0.0 ? -t : t, n.y >= 0.0 ? -t : t);
  return normalize(n);
}
float spotFactor(float cosine) {
  if (falloff == 0) return 1.0;
  if (falloff == 1) {
    float t = clamp((cosine - cosOuter) / max(cosInner - cosOuter, 1e-6), 0.0, 1.0);
    return t * t;
  }
  return clamp((outerAngle - acos(clamp(cosine, -1.0, 1.0))) / max(outerAngle - innerAngle, 1e-6), 0.0, 1.0);
}
void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 at = texelFetch(positions, pixel, 0);
  if (at.w < 0.5) discard;
  vec4 albedo = texelFetch(albedos, pixel, 0);
  vec3 n = texelFetch(normals, pixel, 0).xyz;
  vec3 s = albedo.w < 0.0 ? n : unpacked(albedo.w);
  vec3 towards = kind == 1 ? -lampDirection : lampPosition - at.xyz;
  float reach = length(towards);
  towards /= reach;
  float facing = dot(s, towards), flatFacing = dot(n, towards);
  if (facing <= 0.0 || flatFacing <= 0.0) discard;
  // Points are moved off the surface by as much as a texel of the map, seen at this slant, may span.
  float wide = kind == 1 ? texel : texel * reach;
  float slant = sqrt(max(0.0, 1.0 - flatFacing * flatFacing));
  vec3 p = at.xyz + n * (wide * (1.5 * slant + 0.25));
  float visible = 0.0;
  if (kind == 1) {
    vec3 onMap = (toMap * vec4(p, 1.0)).xyz * 0.5 + 0.5;
    float depth = dot(lampDirection, p);
    vec2 size = vec2(textureSize(flatMap, 0)), place = onMap.xy * size - 0.5, base = floor(place), f = place - base;
    for (int i = 0; i < 4; ++i) {
      vec2 corner = vec2(i & 1, i >> 1);
      float near = texelFetch(flatMap, clamp(ivec2(base + corner), ivec2(0), ivec2(size) - 1), 0).r;
      vec2 share = mix(1.0 - f, f, corner);
      visible += share.x * share.y * (near > depth - wide ? 1.0 : 0.0);
    }
  } else {
    vec3 from = p - lampPosition;
    float depth = length(from);
    vec3 side = normalize(cross(from, abs(from.y) < 0.9 * depth ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0)));
    vec3 other = cross(from / depth, side);
    for (int i = 0; i < 4; ++i) {
      vec2 corner = vec2(i & 1, i >> 1) - 0.5;
      float near = texture(cube, from + (side * corner.x + other * corner.y) * wide).r;
      visible += near > depth - wide ? 0.25 : 0.0;
    }
  }
  float fall = kind == 1 ? 1.0 : spotFactor(dot(-towards, lampDirection)) / (reach * reach);
  outRadiance = vec4(albedo.rgb / pi * power * (facing * fall * visible), 0.0);
}
`;

/** Divides the sums of splats, and puts the picture together: linear radiance. */
export const divideFragment = /* glsl */ `#version 300 es
precision highp float;
precision highp int;
layout(location = 0) out vec4 outRadiance;
uniform highp sampler2D positions, normals, albedos, radiances, lampLight, sums;
uniform highp sampler2D sky;
uniform bool hasSky, showDirect, showIndirect;
uniform mat3 skyFromWorld;
uniform mat4 worldFromScreen;
uniform vec4 eye;
uniform vec2 size;
const float pi = 3.14159265358979;

// The sums of splats at a pixel. Where no record serves, in cracks between records, those of the nearest pixels of the
// same plane stand in; the overlay of what is left out marks these pixels.
vec4 sumAt(ivec2 pixel) {
  vec4 sum = texelFetch(sums, pixel, 0);
  vec3 p = texelFetch(positions, pixel, 0).xyz, n = texelFetch(normals, pixel, 0).xyz;
  for (int ring = 1; ring <= 16 && sum.w <= 0.0; ring *= 2) {
    for (int i = 0; i < 16; ++i) {
      float angle = 2.0 * pi * (float(i) + 0.5) / 16.0;
      ivec2 other = pixel + ivec2(round(float(ring) * vec2(cos(angle), sin(angle))));
      if (any(lessThan(other, ivec2(0))) || any(greaterThanEqual(other, ivec2(size)))) continue;
      vec3 d = texelFetch(positions, other, 0).xyz - p;
      bool samePlane = dot(texelFetch(normals, other, 0).xyz, n) > 0.98 && abs(dot(d, n)) < 0.1 * length(d);
      vec4 found = texelFetch(sums, other, 0);
      if (samePlane && found.w > 0.0) sum += vec4(found.rgb / found.w, 1.0);
    }
  }
  return sum;
}
vec3 skyTowards(vec3 direction) {
  vec3 d = skyFromWorld * direction;
  return texture(sky, vec2(0.5 + atan(d.x, -d.z) / (2.0 * pi), acos(clamp(d.y, -1.0, 1.0)) / pi)).rgb;
}
void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  if (texelFetch(positions, pixel, 0).w < 0.5) {
    vec4 far = worldFromScreen * vec4(gl_FragCoord.xy / size * 2.0 - 1.0, 1.0, 1.0);
    vec3 direction = eye.w > 0.5 ? normalize(far.xyz / far.w - eye.xyz) : -eye.xyz;
    outRadiance = vec4(hasSky ? skyTowards(direction) : vec3(0.0), 1.0);
    return;
  }
  vec4 sum = sumAt(pixel);
  vec3 radiance = showDirect ? texelFetch(radiances, pixel, 0).rgb + texelFetch(lampLight, pixel, 0).rgb : vec3(0.0);
  if (showIndirect && sum.w > 0.0) radiance += texelFetch(albedos, pixel, 0).rgb / pi * sum.rgb / sum.w;
  outRadiance = vec4(radiance, 1.0);
}
`;
