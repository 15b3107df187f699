// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Passes over the whole picture: the light of a lamp, the division of the sums of splats, and the display.

import { unpacking } from './records';

export const screenVertex = /* glsl */ `#version 300 es
in vec3 position;
void main() { gl_Position = vec4(position.xy, 0.0, 1.0); }
`;

/** Sets depths as the graphics card computes them, because splats are compared with these: surfaces have other ones. */
export const depthFragment = /* glsl */ `#version 300 es
precision highp float;
uniform highp sampler2D positions;
uniform mat4 viewProjection;
void main() {
  vec4 at = texelFetch(positions, ivec2(gl_FragCoord.xy), 0), clip = viewProjection * vec4(at.xyz, 1.0);
  gl_FragDepth = at.w > 0.5 ? 0.5 + 0.5 * clip.z / clip.w : 1.0;
}
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
uniform float lightScale;  // of the light in sums, so that half floats hold them
uniform float cosInner, cosOuter, innerAngle, outerAngle;
uniform int falloff;  // 0: none, 1: smooth, 2: linear
uniform mat4 toMap;   // of a sun
uniform vec3 mapX, mapY;        // unit vectors along the sides of the map of a sun
uniform float tangent, farthest;  // of the angular radius of a sun; how far things may be in its way, m
uniform float texel;  // of the map: m for a sun, m at the distance of 1 m for other lamps
const float pi = 3.14159265358979;

${unpacking}
float spotFactor(float cosine) {
  if (falloff == 0) return 1.0;
  if (falloff == 1) {
    float t = clamp((cosine - cosOuter) / max(cosInner - cosOuter, 1e-6), 0.0, 1.0);
    return t * t;
  }
  return clamp((outerAngle - acos(clamp(cosine, -1.0, 1.0))) / max(outerAngle - innerAngle, 1e-6), 0.0, 1.0);
}
// What the map of a sun holds beside a point p, at a texel near an offset in metres: where the middle of that texel is beside p, how far what
// is there is before p along the sun's light, and how high above the plane through p; all in metres. The plane is evaluated at
// the middle of the texel as well, so that a surface does not shade itself however slanted it is, and p need not be moved off it.
vec4 inTheWay(vec2 place, float depth, vec3 n, vec2 offset) {
  ivec2 texels = textureSize(flatMap, 0), at = clamp(ivec2(floor(place + offset / texel)), ivec2(0), texels - 1);
  vec2 middle = (vec2(at) + 0.5 - place) * texel;
  float before = depth - texelFetch(flatMap, at, 0).r;
  return vec4(middle, before, dot(n, mapX * middle.x + mapY * middle.y) - dot(n, lampDirection) * before);
}
vec2 disc(int i, int count) {  // Vogel's spiral
  float angle = 2.39996323 * float(i);
  return sqrt((float(i) + 0.5) / float(count)) * vec2(cos(angle), sin(angle));
}
// The share of a sun's disc that a point sees: the mean distance of what is in the way gives the width of the penumbra.
float sunVisibility(vec3 p, vec3 n) {
  vec2 place = ((toMap * vec4(p, 1.0)).xy * 0.5 + 0.5) * vec2(textureSize(flatMap, 0));
  float depth = dot(lampDirection, p), sum = 0.0, count = 0.0, least = 0.25 * texel;
  float widest = tangent * min(farthest, 400.0 * texel / max(tangent, 1e-6));
  for (int i = 0; i < 32 && tangent > 0.0; ++i) {
    // Denser towards the middle, so that also what is near is found: its cone is narrow.
    vec2 spread = disc(i, 32);
    vec4 found = inTheWay(place, depth, n, widest * dot(spread, spread) * spread);
    // Only what is in the cone from the point to the sun's disc is in its way.
    if (found.w > least && length(found.xy) < tangent * found.z + texel) sum += found.z, count += 1.0;
  }
  float radius = max(texel, count > 0.0 ? tangent * sum / count : 0.0), visible = 0.0;
  for (int i = 0; i < 32; ++i) visible += inTheWay(place, depth, n, radius * disc(i, 32)).w > least ? 0.0 : 1.0;
  return visible / 32.0;
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
  float visible = 0.0;
  if (kind == 1) {
    visible = sunVisibility(at.xyz, n);
  } else {
    // The point is moved off its surface by as much as a texel of the map, seen at this slant, may span.
    float wide = texel * reach, slant = sqrt(max(0.0, 1.0 - flatFacing * flatFacing));
    vec3 from = at.xyz + n * (wide * (1.5 * slant + 0.25)) - lampPosition;
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
  outRadiance = vec4(albedo.rgb / pi * power * (lightScale * facing * fall * visible), 0.0);
}
`;

/** Divides the sums of splats, and puts the picture together: linear radiance. */
export const divideFragment = /* glsl */ `#version 300 es
precision highp float;
precision highp int;
layout(location = 0) out vec4 outRadiance;
uniform highp sampler2D positions, normals, albedos, radiances, lampLight, sums, glossSums;
uniform highp sampler2D sky;
uniform bool hasSky, showDirect, showIndirect;
uniform float lightScale;  // of the light in lampLight and glossSums
uniform mat3 skyFromWorld;
uniform mat4 worldFromScreen;
uniform vec4 eye;
uniform vec2 size;
const float pi = 3.14159265358979;

// The sums of splats of an image at a pixel. Where no record serves, in cracks between records, the nearest pixels of the same surface
// stand in: of the same plane if there are any, otherwise of similar normals, and on mouldings thinner than pixels any surface that is
// about as far away. An overlay marks them.
vec4 sumAt(highp sampler2D image, ivec2 pixel) {
  vec4 sum = texelFetch(image, pixel, 0);
  vec3 p = texelFetch(positions, pixel, 0).xyz, n = texelFetch(normals, pixel, 0).xyz;
  for (int attempt = 0; attempt < 3; ++attempt) {
    vec2 similar = attempt == 0 ? vec2(0.98, 0.1) : attempt == 1 ? vec2(0.5, 0.7) : vec2(-2.0, 2.0);
    float most = attempt == 2 && eye.w > 0.5 ? 0.1 * length(p - eye.xyz) : 1e30;
    for (int ring = 1; ring <= 16 && sum.w <= 0.0; ring *= 2) {
      for (int i = 0; i < 16; ++i) {
        float angle = 2.0 * pi * (float(i) + 0.5) / 16.0;
        ivec2 other = pixel + ivec2(round(float(ring) * vec2(cos(angle), sin(angle))));
        if (any(lessThan(other, ivec2(0))) || any(greaterThanEqual(other, ivec2(size)))) continue;
        vec3 d = texelFetch(positions, other, 0).xyz - p;
        float turned = dot(texelFetch(normals, other, 0).xyz, n);
        vec4 found = texelFetch(image, other, 0);
        if (turned > similar.x && abs(dot(d, n)) < similar.y * length(d) && length(d) < most && found.w > 0.0)
          sum += vec4(found.rgb / found.w, 1.0);
      }
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
  vec4 sum = sumAt(sums, pixel);
  vec3 radiance = showDirect ? texelFetch(radiances, pixel, 0).rgb + texelFetch(lampLight, pixel, 0).rgb / lightScale : vec3(0.0);
  if (showIndirect && sum.w > 0.0) radiance += texelFetch(albedos, pixel, 0).rgb / pi * sum.rgb / sum.w;
  vec4 gloss = texelFetch(normals, pixel, 0).w > 0.5 ? sumAt(glossSums, pixel) : vec4(0.0);
  if (showIndirect && gloss.w > 0.0) radiance += gloss.rgb / (gloss.w * lightScale);
  outRadiance = vec4(min(radiance, 60000.0), 1.0); // the largest half float of mirrored pictures
}
`;
