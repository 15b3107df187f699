// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The geometry pass, and the same surfaces as lights see them.
//
//   positions    position; the number of the material + 1, or 0 where nothing is seen
//   normals      geometric normal on the side of the eye; the kind of gloss (0 none, 1 rough, 2 mirror, 3 glass)
//   albedos      diffuse albedo towards the eye (of glass, the colour of what passes); the shading normal, packed, or −1 where it is the geometric one
//   radiances    emitted radiance and the reflected light of the light map; the mirrored share of light, packed

import { LUMINANCE } from './records';

export const surfaceVertex = /* glsl */ `#version 300 es
precision highp float;
in vec3 position, faceNormal, normal;
in vec2 uv, uv2, lightUv;
in vec4 color, tangent;
in vec3 alongU, alongV;
uniform mat4 viewProjection;
out vec3 vPosition, vNormal;
flat out vec3 vFace;
out vec2 vUv, vUv2, vLightUv;
out vec4 vColor, vTangent;
flat out vec3 vAlongU, vAlongV;
void main() {
  vPosition = position;
  vFace = faceNormal;
  vNormal = normal;
  vUv = uv;
  vUv2 = uv2;
  vLightUv = lightUv;
  vColor = color;
  vTangent = tangent;
  vAlongU = alongU;
  vAlongV = alongV;
  gl_Position = viewProjection * vec4(position, 1.0);
}
`;

const values = /* glsl */ `
struct Value {
  vec3 constant;
  mat3 transform;
  int uvSet, channel;
  bool textured, invert, square;
};
in vec3 vPosition, vNormal;
flat in vec3 vFace;
in vec2 vUv, vUv2, vLightUv;
in vec4 vColor;
uniform vec4 eye;  // position and 1, or the direction towards an eye at infinity and 0
uniform bool frontOnly, twoSided, culled, vertexColors;
uniform float cutoff;
uniform Value opacity;
uniform sampler2D opacityMap;

vec2 placeOf(Value value) { return (value.transform * vec3(value.uvSet == 0 ? vUv : vUv2, 1.0)).xy; }
vec3 valueAt(Value value, sampler2D map, vec2 at) {
  if (!value.textured) return value.constant;
  vec4 texel = texture(map, at);
  vec3 found = value.channel < 0 ? texel.rgb : vec3(texel[value.channel]);
  if (value.invert) found = 1.0 - found;
  if (value.square) found *= found;
  return value.constant * found;
}
vec3 valueOf(Value value, sampler2D map) { return valueAt(value, map, placeOf(value)); }
float opacityOf() {
  float found = valueOf(opacity, opacityMap).r * (vertexColors ? vColor.a : 1.0);
  return cutoff < 0.0 ? found : found >= cutoff ? 1.0 : 0.0;
}
vec3 towardsEye() { return normalize(eye.xyz - eye.w * vPosition); }
`;

/** For RELIEF: the normal that a normal map or a height map gives, as Geometry::mapped_normal of core/scene/scene.cpp. */
const relief = /* glsl */ `
in vec4 vTangent;
flat in vec3 vAlongU, vAlongV;  // derivatives of the position along the map's coordinates
uniform bool isHeight;  // or else a normal map
uniform float reliefScale;
uniform bool hasTangents;
uniform Value relief;
uniform sampler2D reliefMap;

vec3 inTangentSpace(vec3 n, bool turned) {
  vec3 along = hasTangents ? vTangent.xyz : vAlongU, u = along - n * dot(n, along);
  if (dot(u, u) <= 0.0) return n;
  u = normalize(u);
  vec3 v = cross(n, u);
  bool rightHanded = (vTangent.w > 0.0) != (turned != back);
  // Without tangents, green grows upwards in the image, which is against v.
  vec3 up = (hasTangents ? rightHanded : dot(v, vAlongV) <= 0.0) ? v : -v;
  vec3 texel = 2.0 * valueOf(relief, reliefMap) - 1.0;
  vec3 found = (u * texel.x + up * texel.y) * reliefScale + n * texel.z;
  return dot(found, found) > 0.0 ? normalize(found) : n;
}
float heightAt(vec2 at) {
  vec3 found = valueAt(relief, reliefMap, at);
  return reliefScale * (relief.channel < 0 ? dot(found, ${LUMINANCE}) : found.r);
}
vec3 withRelief(vec3 n, bool turned) {
  if (!isHeight) return inTangentSpace(n, turned);
  vec2 at = placeOf(relief), texel = 1.0 / vec2(textureSize(reliefMap, 0));
  // Differences of one texel, or of what the pixel covers: its normal is then about the mean of those that it covers.
  vec2 across = max(texel, 0.5 * (abs(dFdx(at)) + abs(dFdy(at))));
  float hu = (heightAt(at + vec2(across.x, 0.0)) - heightAt(at - vec2(across.x, 0.0))) / (2.0 * across.x);
  float hv = (heightAt(at + vec2(0.0, across.y)) - heightAt(at - vec2(0.0, across.y))) / (2.0 * across.y);
  vec3 plane = cross(vAlongU, vAlongV);
  float area = dot(plane, plane);
  if (area <= 0.0) return n;
  vec3 gradient = (cross(vAlongV, plane) * hu + cross(plane, vAlongU) * hv) / area;
  return normalize(n - gradient + n * dot(gradient, n));
}

uniform bool hasMoments;
uniform sampler2D momentR, momentG, momentB;  // of the light map: from where its light comes
// What the light map's irradiance changes by if the normal does: exact where all of its light is above both horizons.
vec3 lightAlong(vec3 turn) {
  return vec3(dot(texture(momentR, vLightUv).xyz, turn), dot(texture(momentG, vLightUv).xyz, turn), dot(texture(momentB, vLightUv).xyz, turn));
}
`;

export const surfaceFragment = /* glsl */ `#version 300 es
precision highp float;
precision highp int;
${values}
layout(location = 0) out vec4 outPosition;
layout(location = 1) out vec4 outNormal;
layout(location = 2) out vec4 outAlbedo;
layout(location = 3) out vec4 outRadiance;
uniform float number, gloss, inside;
uniform bool saturates, emissionTwoSided, hasLight, hidden, inMirror;
uniform bool back;  // whether the mesh is the reversed side of another
uniform Value diffuse, metallic, transmission, emission;
uniform sampler2D diffuseMap, metallicMap, transmissionMap, emissionMap, lightMap;
uniform float coat[32];
uniform vec3 mirrored[32];
uniform vec2 metal[32];
uniform vec4 clip;  // a plane, behind which nothing is drawn: normal and offset
uniform float lightScale;
uniform vec2 depths;  // of perspective views
#ifdef RELIEF
${relief}
#endif

float packed(vec3 n) {
  n /= abs(n.x) + abs(n.y) + abs(n.z);
  vec2 f = n.z >= 0.0 ? n.xy : (1.0 - abs(n.yx)) * vec2(n.x >= 0.0 ? 1.0 : -1.0, n.y >= 0.0 ? 1.0 : -1.0);
  vec2 whole = floor((f * 0.5 + 0.5) * 4095.0 + 0.5);
  return whole.x + 4096.0 * whole.y;
}
float coatAt(float cosine) {
  float x = clamp(cosine, 0.0, 1.0) * 31.0;
  int i = min(int(x), 30);
  return mix(coat[i], coat[i + 1], x - float(i));
}
vec3 mirroredAt(float cosine, vec3 color, float metallic) {
  float x = clamp(cosine, 0.0, 1.0) * 31.0;
  int i = min(int(x), 30);
  vec3 coated = mix(mirrored[i], mirrored[i + 1], x - float(i));
  vec2 shares = mix(metal[i], metal[i + 1], x - float(i));
  return mix(coated, color * shares.x + shares.y, metallic);
}
float packedShare(vec3 share) {
  vec3 root = floor(sqrt(clamp(share, 0.0, 1.0)) * 255.0 + 0.5);
  return root.r + 256.0 * root.g + 65536.0 * root.b;
}
void main() {
  vec3 towards = towardsEye();
  bool front = dot(vFace, towards) > 0.0;
  if (!front && (frontOnly || culled)) discard;
  if (dot(clip.xyz, vPosition) < clip.w) discard;
  if (opacityOf() < 0.5 || (hidden && !inMirror)) discard;
  vec3 n = front ? vFace : -vFace;
  vec3 outer = back ? -vFace : vFace, even = back ? -normalize(vNormal) : normalize(vNormal);
  bool turned = dot(even, outer) < 0.0;
  if (turned) even = -even;
  vec3 s = even;
#ifdef RELIEF
  s = withRelief(even, turned);
#endif
  if (dot(outer, n) < 0.0) even = -even, s = -s;
  // As in the core, a normal that faces away from the eye is bent towards it.
  float facing = dot(s, towards);
  if (facing <= 0.0) s = normalize(s + towards * (1e-3 - facing));
  bool bends = dot(s, n) < 0.9999999;
  vec3 albedo = valueOf(diffuse, diffuseMap) * (vertexColors ? vColor.rgb : vec3(1.0));
  float metalShare = valueOf(metallic, metallicMap).r;
  vec3 share = gloss > 0.5 ? mirroredAt(abs(dot(s, towards)), albedo, metalShare) : vec3(0.0);
  albedo *= (1.0 - metalShare) * (1.0 - valueOf(transmission, transmissionMap).r);
  albedo *= coatAt(abs(dot(s, towards))) / (1.0 - inside * (saturates ? albedo : vec3(1.0)));
  if (gloss > 2.5) albedo = valueOf(diffuse, diffuseMap);  // of glass it is the colour of what passes
  else if (!front && !twoSided) albedo = share = vec3(0.0);
  vec3 radiance = front || emissionTwoSided ? valueOf(emission, emissionMap) : vec3(0.0);
  if (hasLight) {
    vec3 E = texture(lightMap, vLightUv).rgb;
#ifdef RELIEF
    if (hasMoments) E = max(E + lightAlong(s - even), 0.0);
#endif
    radiance += albedo * E * lightScale * ${1 / Math.PI};
  }
  // Floats between 0 and 1 tell near depths apart far better than distant ones, which their logarithms make alike.
  gl_FragDepth = eye.w > 0.5 ? (-log2(gl_FragCoord.w) - depths.x) * depths.y : gl_FragCoord.z;
  outPosition = vec4(vPosition, number);
  outNormal = vec4(n, gloss);
  outAlbedo = vec4(albedo, bends ? packed(s) : -1.0);
  outRadiance = vec4(radiance, packedShare(share));
}
`;

/** The distance from a light, of what casts shadows. */
export const shadowFragment = /* glsl */ `#version 300 es
precision highp float;
precision highp int;
${values}
layout(location = 0) out vec4 outDistance;
uniform vec3 sunDirection;  // that the light of a sun travels along; eye.w is 0 then
void main() {
  // Light passes through a culled back where the lit point sees the back, so where the light sees the front.
  if (culled && dot(vFace, towardsEye()) > 0.0) discard;
  if (opacityOf() < 0.5) discard;
  outDistance = vec4(eye.w > 0.5 ? distance(eye.xyz, vPosition) : dot(sunDirection, vPosition));
}
`;
