// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Exposure, tone mapping and overlays. `filmic` is that of python/eclat/images/tone.py; AgX is the approximation of
// Troy Sobotka's view transform that three.js contains.

import { ShaderChunk } from 'three';

export const displayFragment = /* glsl */ `#version 300 es
precision highp float;
precision highp int;
layout(location = 0) out vec4 outColor;
uniform highp sampler2D picture, positions, normals, albedos, sums, glossSums, counts, errors;
uniform int toneMapping;  // 0: none, 1: filmic, 2: AgX
uniform int overlay;      // 0: none, 1: weights, 2: density of splats, 3: what is approximated, 4: records, 5: nearest obstacle, 6: noise, 7: lobes, 8: estimated error
uniform float diagonal;   // of the scene, m
uniform float scale;      // 2 to the power of the exposure
uniform bool comparing, showDifference;
uniform highp sampler2D pagePicture, truth;  // of the page, averaged over pixels; of the server, row 0 at the top
uniform float wipe, differenceFloor;         // pixels from the left where the truth begins
${ShaderChunk['tonemapping_pars_fragment']}
vec3 filmic(vec3 x) {
  const float grey = 0.18, power = 1.0 / (1.0 - grey);
  float s = pow(grey, power) * (1.0 - grey) / grey;
  vec3 y = pow(max(x, 0.0), vec3(power));
  return y / (y + s);
}
vec3 encoded(vec3 x) {
  x = clamp(x, 0.0, 1.0);
  return mix(1.055 * pow(x, vec3(1.0 / 2.4)) - 0.055, 12.92 * x, vec3(lessThanEqual(x, vec3(0.0031308))));
}
// From dark blue over green to yellow, for shares from 0 to 1.
vec3 ramp(float t) {
  t = clamp(t, 0.0, 1.0);
  return mix(mix(vec3(0.15, 0.1, 0.4), vec3(0.1, 0.6, 0.55), min(1.0, 2.0 * t)), vec3(1.0, 0.9, 0.2), max(0.0, 2.0 * t - 1.0));
}
vec3 displayed(vec3 radiance) {
  vec3 shown = toneMapping == 2 ? AgXToneMapping(radiance) : toneMapping == 1 ? filmic(radiance * scale) : radiance * scale;
  return encoded(shown);
}
// Red where the page is brighter than the truth, blue where it is darker; the full colour is 20 %.
vec3 differenceOf(vec3 page, vec3 exact) {
  const vec3 luminance = vec3(0.2126, 0.7152, 0.0722);
  float y = dot(exact, luminance), relative = dot(page - exact, luminance) / sqrt(y * y + differenceFloor);
  vec3 full = relative > 0.0 ? vec3(0.7, 0.05, 0.1) : vec3(0.05, 0.25, 0.75);
  return mix(vec3(0.97), full, min(1.0, 5.0 * abs(relative)));
}
void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec3 radiance = texelFetch(picture, pixel, 0).rgb;
  if (comparing) {
    vec2 size = vec2(textureSize(picture, 0)), at = gl_FragCoord.xy / size;
    vec3 exact = texture(truth, vec2(at.x, 1.0 - at.y)).rgb, page = texture(pagePicture, at).rgb;
    bool border = abs(gl_FragCoord.x - wipe) < 1.0;
    if (showDifference || gl_FragCoord.x > wipe || border) {
      vec3 color = showDifference ? differenceOf(page, exact) : border ? vec3(1.0) : displayed(exact);
      outColor = vec4(color, 1.0);
      return;
    }
    radiance = page;
  }
  vec3 color = displayed(radiance);
  bool seen = texelFetch(positions, pixel, 0).w > 0.5;
  float weight = texelFetch(sums, pixel, 0).w, gloss = texelFetch(normals, pixel, 0).w;
  float light = dot(color, vec3(0.2126, 0.7152, 0.0722));
  if (seen && overlay == 1) color = weight > 0.0 ? mix(vec3(light), ramp(weight / 4.0), 0.7) : vec3(0.85, 0.1, 0.1);
  if (seen && overlay == 2) color = ramp(log2(1.0 + texelFetch(counts, pixel, 0).r) / 6.0);
  if (seen && overlay == 3) {
    // Diffuse surfaces without a record, and gloss that is approximated: of what is rough, and of mirrors and the like.
    bool dark = weight <= 0.0 && any(greaterThan(texelFetch(albedos, pixel, 0).rgb, vec3(0.0)));
    float approximated = texelFetch(picture, pixel, 0).w;
    bool glass = approximated > 1.5, dull = glass || (gloss > 0.5 && approximated > 0.5);
    vec3 mark = dark && !glass ? vec3(0.9, 0.15, 0.1) : glass || gloss > 1.5 ? vec3(0.1, 0.7, 0.9) : vec3(0.95, 0.65, 0.1);
    if (dark || dull) color = (pixel.x + pixel.y) % 12 < 6 ? mark : mix(vec3(light), mark, 0.3);
  }
  if (seen && overlay == 4) {
    vec2 drawn = min(texelFetch(counts, pixel, 0).rg, 1.0);
    color = mix(mix(0.6 * color, vec3(0.3, 0.75, 1.0), 0.8 * drawn.r), vec3(1.0, 0.9, 0.2), drawn.g);
  }
  if (seen && overlay == 7) {
    // By colour, which lobes come from records: the matte one, the glossy one, both; and what eclat render traces.
    vec3 albedo = texelFetch(albedos, pixel, 0).rgb;
    bool matte = max(albedo.r, max(albedo.g, albedo.b)) > 0.0;
    bool matteCached = matte && weight > 0.0, glossCached = gloss > 0.5 && texelFetch(glossSums, pixel, 0).w > 0.0;
    vec3 mark = matteCached && glossCached ? vec3(0.1, 0.75, 0.8) : glossCached ? vec3(0.2, 0.35, 0.95)
        : matteCached ? vec3(0.15, 0.7, 0.25) : vec3(0.9, 0.15, 0.1);
    bool traced = (matte && !matteCached) || (gloss > 0.5 && !glossCached);
    if (traced && matteCached || traced && glossCached) mark = (pixel.x + pixel.y) % 12 < 6 ? mark : vec3(0.95, 0.6, 0.1);
    else if (traced && gloss > 0.5) mark = vec3(0.95, 0.6, 0.1);
    if (matte || gloss > 0.5) color = mix(vec3(light), mark, 0.75);
  }
  if (seen && (overlay == 5 || overlay == 6)) {
    // Distances from a thousandth of the diagonal to all of it, and noise to 10 %.
    vec4 sum = texelFetch(counts, pixel, 0);
    float value = sum.r / max(sum.w, 1e-30);
    float share = overlay == 5 ? 1.0 + log2(max(value / diagonal, 1e-6)) / 10.0 : 10.0 * value;
    if (sum.w > 0.0) color = mix(vec3(light), ramp(share), 0.8);
  }
  if (seen && overlay == 8) {
    // By logarithm, from a thousandth to a tenth.
    vec4 error = texelFetch(errors, pixel, 0);
    color = error.w > 0.0 ? mix(vec3(light), ramp(0.5 * (3.0 + log(max(error.r, 1e-6)) / log(10.0))), 0.8) : vec3(0.85, 0.1, 0.1);
  }
  outColor = vec4(color, 1.0);
}
`;
