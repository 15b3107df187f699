// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

/**
 * Light maps that `eclat bake` writes, in three.js: a plugin for its GLTFLoader.
 *
 *     loader.register((parser) => new EclatLightmap(parser));
 *
 * A baked file holds irradiance E twice: embedded, as 8-bit sRGB times `MOZ_lightmap.intensity`, and in full range as
 * EXR beside the file. The file names a JSON side-car (`asset.extras.eclat.lightmap`), and that the EXR of each texture.
 * Either version becomes `material.lightMap`. three.js takes a light map for irradiance and reflects albedo / π · E of
 * it, so that no factor of π appears here. Where a side-car cannot be read the embedded map is taken, with a warning.
 */

import {
  DataTexture,
  DataUtils,
  FileLoader,
  FloatType,
  HalfFloatType,
  LinearFilter,
  LinearSRGBColorSpace,
  LoaderUtils,
  RGBAFormat,
  SRGBColorSpace,
} from 'three';

const EXTENSION = 'MOZ_lightmap';
const SIDECAR_VERSION = 1;
const LARGEST_HALF = 65504;

export class EclatLightmap {
  /**
   * @param {GLTFParser} parser what `GLTFLoader.register` hands over
   * @param {object} [options]
   * @param {boolean} [options.exr=true] read the EXR side-car where the file names one; false: the embedded map only
   */
  constructor(parser, { exr = true } = {}) {
    this.name = EXTENSION;
    this.parser = parser;
    this.exr = exr;
    this.maps = new Map();
    this.sidecar = undefined;
  }

  /** GLTFLoader calls this for every material, before it makes it. */
  async extendMaterialParams(materialIndex, materialParams) {
    const extension = this.parser.json.materials[materialIndex].extensions?.[EXTENSION];
    if (extension === undefined) return;
    // The extension's draft has no texCoord: files that follow it mean the second set.
    const { index, texCoord = 1, intensity = 1 } = extension;
    if (this.parser.json.textures?.[index] === undefined) {
      throw new Error(`EclatLightmap: material ${materialIndex}: the file has no texture ${index}`);
    }
    const map = await this.map(index, texCoord);
    if (map === null) return;
    materialParams.lightMap = map.texture;
    materialParams.lightMapIntensity = map.intensity ?? intensity;
  }

  /**
   * The light map in texture `index`, read by texture coordinates `texCoord`: loaded once, shared by materials.
   *
   * @returns {Promise<?{texture: Texture, intensity: number|undefined}>} an intensity where the materials' own does not
   *   apply; null where there is no map that can be read
   */
  map(index, texCoord) {
    const key = `${index}/${texCoord}`;
    if (!this.maps.has(key)) this.maps.set(key, this.load(index, texCoord));
    return this.maps.get(key);
  }

  async load(index, texCoord) {
    const map = (this.exr && (await this.fullRange(index))) || (await this.embedded(index));
    if (map === null) return null;
    const { texture } = map;
    texture.channel = texCoord;
    texture.flipY = false;
    // Mipmaps would mix charts: only a few texels lie between them.
    texture.generateMipmaps = false;
    texture.minFilter = LinearFilter;
    texture.magFilter = LinearFilter;
    texture.needsUpdate = true;
    return map;
  }

  async embedded(index) {
    const loaded = await this.parser.getDependency('texture', index);
    if (loaded === null) {
      warn(`the light map in texture ${index} cannot be read; its materials stay without`);
      return null;
    }
    // A copy: another material may use the same image for something else. Copies share what is on the GPU.
    const texture = loaded.clone();
    texture.colorSpace = SRGBColorSpace;
    return { texture };
  }

  async fullRange(index) {
    const { lightmap: uri, lightmap_set: mark } = this.parser.json.asset?.extras?.eclat ?? {};
    if (uri === undefined) return null;
    try {
      this.sidecar ??= this.readSidecar(uri);
      const { pages, path, set } = await this.sidecar;
      if (set !== mark) throw new Error(`${uri} is of another bake than the scene`);
      const page = pages.find((candidate) => candidate.gltf_texture === index);
      if (page === undefined) throw new Error(`${uri} has no page for texture ${index}`);
      return await this.readPage(LoaderUtils.resolveURL(encodeURIComponent(page.exr), path));
    } catch (error) {
      warn(`${error.message}; taking the embedded light map (8 bits a channel, bright places may be clipped)`);
      return null;
    }
  }

  /** The JSON side-car's pages, the mark of its bake, and the folder in which their files lie. */
  async readSidecar(uri) {
    const url = LoaderUtils.resolveURL(uri, this.parser.options.path);
    const text = await this.fetch(url, 'text');
    const { version, pages, set } = parseJson(text, url);
    if (version !== SIDECAR_VERSION || !Array.isArray(pages)) {
      throw new Error(`${url}: expected a side-car of version ${SIDECAR_VERSION}, got version ${version}`);
    }
    return { pages, set, path: LoaderUtils.extractUrlBase(url) };
  }

  /**
   * An EXR as a texture of half floats, which every WebGL 2 filters. Irradiance of daylight in lux exceeds what they
   * hold, that of a dim room loses digits: a power of two brings the brightest texel into range, the intensity undoes it.
   */
  async readPage(url) {
    const { EXRLoader } = await import('three/addons/loaders/EXRLoader.js');
    const bytes = await this.fetch(url, 'arraybuffer');
    const { data, width, height } = parseExr(new EXRLoader().setDataType(FloatType), bytes, url);
    let peak = 0;
    for (let i = 0; i < data.length; i += 4) peak = Math.max(peak, data[i], data[i + 1], data[i + 2]);
    const fits = peak === 0 || (peak >= 1 && peak <= LARGEST_HALF);
    const intensity = fits ? 1 : 2 ** Math.floor(Math.log2(peak));
    const half = new Uint16Array(data.length);
    const row = 4 * width;
    for (let y = 0; y < height; y++) {
      // EXRLoader puts the lowest row first; texture coordinates of glTF start at the top.
      const from = (height - 1 - y) * row;
      for (let i = 0; i < row; i++) {
        half[y * row + i] = DataUtils.toHalfFloat(i % 4 === 3 ? 1 : data[from + i] / intensity);
      }
    }
    const texture = new DataTexture(half, width, height, RGBAFormat, HalfFloatType);
    texture.colorSpace = LinearSRGBColorSpace;
    texture.name = url.split('/').pop();
    return { texture, intensity };
  }

  /** A file through the loading manager, with what the user told GLTFLoader about requests. */
  async fetch(url, responseType) {
    const { manager, requestHeader, withCredentials, crossOrigin } = this.parser.options;
    const loader = new FileLoader(manager).setResponseType(responseType).setRequestHeader(requestHeader ?? {});
    loader.setWithCredentials(withCredentials || crossOrigin === 'use-credentials');
    try {
      return await loader.loadAsync(url);
    } catch (error) {
      throw new Error(`${url} cannot be read (${error.message ?? 'no answer'})`);
    }
  }
}

function parseJson(text, url) {
  try {
    return JSON.parse(text);
  } catch (error) {
    throw new Error(`${url} is not JSON (${error.message})`);
  }
}

function parseExr(loader, bytes, url) {
  try {
    return loader.parse(bytes);
  } catch (error) {
    throw new Error(`${url} is not an EXR file that three.js can read (${error.message ?? error})`);
  }
}

function warn(message) {
  console.warn(`EclatLightmap: ${message}`);
}
