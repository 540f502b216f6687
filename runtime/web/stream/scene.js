// Pages and images as objects of three.js.
import { BatchedMesh, BufferAttribute, BufferGeometry, LoadingManager, Matrix4, Mesh, Texture } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { MeshoptDecoder } from 'three/addons/libs/meshopt_decoder.module.js';
import { StreamError } from './error.js';
import { FAILED } from './format.js';

const scheme = 'sightcell-image:';
const bitmapOptions = { premultiplyAlpha: 'none', colorSpaceConversion: 'none' };  // as in GLTFLoader
const texturesOf = (material) => Object.entries(material).filter(([, value]) => value?.isTexture);

/** Corners of a part of an index list, with their attributes in arrays of their own. */
function cut({ index, attributes }, first, count) {
  const corners = index.array.subarray(first, first + count);
  let least = Infinity,
    most = -1;
  for (const corner of corners) {
    least = Math.min(least, corner);
    most = Math.max(most, corner);
  }
  if (most >= attributes.position.count) throw new Error('an index is out of range');
  const part = new BufferGeometry();
  for (const [name, { array, itemSize, normalized, data, offset = 0 }] of Object.entries(attributes)) {
    const stride = data?.stride ?? itemSize;
    const values = new array.constructor((most - least + 1) * itemSize);
    for (let i = 0; i < values.length; ++i) {
      values[i] = array[(least + Math.floor(i / itemSize)) * stride + offset + (i % itemSize)];
    }
    part.setAttribute(name, new BufferAttribute(values, itemSize, normalized));
  }
  return part.setIndex(
    new BufferAttribute(
      corners.map((corner) => corner - least),
      1,
    ),
  );
}

const bytesOf = ({ index, attributes }) =>
  Object.values(attributes).reduce((sum, { array }) => sum + array.byteLength, index.array.byteLength);

export class StreamedScene {
  shown;  // by draw: 1 if a cell lists it
  #front;
  #onMesh;
  #parser;
  #materials = [];  // of the front, then the default one
  #final = new Set();  // as the attributes of pages need them
  #images;  // by material: their numbers
  #textures = [];  // by image
  #draws;  // by geometry
  #pages = new Map();
  #disposed = false;
  #loader = new GLTFLoader().setMeshoptDecoder(MeshoptDecoder);

  constructor(front, group, { workers, onMesh }) {
    // Each instance of the decoder has one set of workers for the whole page.
    if (workers > 0 && typeof Worker === 'function') MeshoptDecoder.useWorkers(workers);
    this.#front = front;
    this.group = group;
    this.#onMesh = onMesh;
    this.shown = new Uint8Array(front.draws.length);
    this.#draws = Array.from({ length: front.geometries }, () => []);
    front.draws.forEach((draw, number) => {
      draw.matrix = new Matrix4();
      for (let k = 0; k < 12; ++k) draw.matrix.elements[k + Math.floor(k / 3)] = front.columns[k][number];
      // Of levels of detail, the finest is drawn.
      if ((draw.flags & 4) === 0 && draw.level === 0) this.#draws[draw.geometry].push(draw);
    });
    /** Until it is fulfilled, no page and no image can be added. */
    this.ready = this.#makeMaterials().catch((cause) => {
      const what = `its materials are damaged: ${cause.message}; pack and upload the scene again`;
      throw new StreamError('corrupt', front.url, what, { cause });
    });
  }

  /** As GLTFLoader makes them. Their textures get an image when one arrives. */
  async #makeMaterials() {
    const { json, images } = this.#front;
    this.#textures = images.map(() => new Set());
    const sources = new Map();
    const manager = new LoadingManager();
    manager.addHandler(new RegExp(`^${scheme}`), {
      load: (url, done) => {
        const texture = new Texture();
        sources.set(texture.source, Number(url.slice(scheme.length)));
        done(texture);
      },
    });
    const source = ({
      source: plain,
      extensions: { EXT_texture_webp: webp, EXT_texture_avif: avif, KHR_texture_basisu: basis } = {},
    }) => webp?.source ?? avif?.source ?? plain ?? basis?.source;
    const document = {
      ...json,
      asset: { version: '2.0' },
      textures: json.textures?.map(({ extensions, ...texture }) => ({
        ...texture,
        source: source({ ...texture, extensions }),
      })),
      images: json.images?.map((image, i) => ({ ...image, uri: `${scheme}${i}` })),
      materials: [...(json.materials ?? []), {}],
      scenes: [{}],
    };
    const { parser } = await new GLTFLoader(manager).parseAsync(document, '');
    this.#parser = parser;
    this.#materials = await parser.getDependencies('material');
    this.#images = this.#materials.map((material) =>
      texturesOf(material).map(([, texture]) => {
        const image = sources.get(texture.source);
        this.#textures[image].add(texture);
        return image;
      }),
    );
    const used = new Set(this.#images.flat());
    images.forEach(({ files }, i) => {
      if (!used.has(i)) for (const file of files) file.state = FAILED;  // another image takes its place
    });
  }

  #material(draw, geometry) {
    const like = { geometry, material: this.#materials.at(draw.material - 1) };
    this.#parser.assignFinalMaterial(like);
    this.#final.add(like.material);
    return like.material;
  }

  /** Reads a page, and returns the bytes that it takes in memory. */
  async addPage(file, bytes) {
    const items = [];
    try {
      const { scene } = await this.#loader.parseAsync(bytes, '');
      if (this.#disposed) return 0;
      scene.traverse(({ geometry }) => geometry && this.#addPrimitive(geometry, items));
    } catch (cause) {
      const what = `it is damaged: ${cause.message}; pack and upload the scene again`;
      throw new StreamError('corrupt', file.url, what, { cause });
    }
    const meshes = new Set(items.map(({ mesh }) => mesh));
    for (const mesh of meshes) {
      mesh.matrixAutoUpdate = false;
      this.#onMesh(mesh);
      this.group.add(mesh);
    }
    const page = { items, meshes };
    this.#pages.set(file, page);
    this.#show(page);
    const geometries = new Set(Array.from(meshes, ({ geometry }) => geometry));
    return Array.from(geometries).reduce((sum, geometry) => sum + bytesOf(geometry), 0);
  }

  #addPrimitive(geometry, items) {
    const list = geometry.userData.sightcell,
      batches = new Map();
    let id = -1,
      first = 0;
    for (let i = 0; i < list.length; i += 2) {
      id += list[i] + 1;
      const part = cut(geometry, first, 3 * list[i + 1]);
      first += 3 * list[i + 1];
      for (const draw of this.#draws[id]) {
        const material = this.#material(draw, geometry);
        // Three.js sorts transparent meshes among each other, and turns the front faces of mirrored ones, if they are
        // meshes of their own.
        const apart =
          material.transparent || material.transmission > 0 || draw.matrix.determinant() < 0 || draw.flags & 1;
        const key = apart ? draw : material;
        if (!batches.has(key)) batches.set(key, { material, members: [] });
        batches.get(key).members.push({ draw, part });
      }
    }
    if (first !== geometry.index.count) throw new Error(`its geometries have ${first / 3} polygons`);
    for (const { material, members } of batches.values()) {
      if (members.length > 1) this.#addBatch(material, members, items);
      else items.push({ mesh: this.#single(material, members[0]), index: -1, draw: members[0].draw });
    }
  }

  #single(material, { draw, part }) {
    const mesh = new Mesh(part, material);
    mesh.matrix = draw.matrix;
    mesh.matrixWorldNeedsUpdate = true;
    return mesh;
  }

  #addBatch(material, members, items) {
    const parts = new Map(members.map(({ part }) => [part, 0]));
    const sum = (count) => Array.from(parts.keys()).reduce((total, part) => total + count(part), 0);
    const mesh = new BatchedMesh(
      members.length,
      sum(({ attributes }) => attributes.position.count),
      sum(({ index }) => index.count),
      material,
    );
    for (const part of parts.keys()) parts.set(part, mesh.addGeometry(part));
    for (const { draw, part } of members) {
      const index = mesh.addInstance(parts.get(part));
      mesh.setMatrixAt(index, draw.matrix);
      items.push({ mesh, index, draw });
    }
    mesh.computeBoundingSphere();
    mesh.sortObjects = false;
  }

  removePage(file) {
    for (const mesh of this.#pages.get(file).meshes) {
      mesh.removeFromParent();
      mesh.geometry.dispose();
      mesh.dispose?.();
    }
    this.#pages.delete(file);
  }

  /** Shows what `shown` lists and has its images. */
  apply() {
    for (const page of this.#pages.values()) this.#show(page);
  }

  #show({ items, meshes }) {
    for (const mesh of meshes) mesh.visible = false;
    for (const { mesh, index, draw } of items) {
      const visible = this.shown[draw.number] === 1 && this.#isReady(draw.material);
      if (index >= 0) mesh.setVisibleAt(index, visible);
      mesh.visible ||= visible;
    }
  }

  #isReady(material) {
    return this.#images.at(material - 1).every((image) => {
      const { shown, files } = this.#front.images[image];
      return shown >= 0 || files.every(({ state }) => state === FAILED);
    });
  }

  /** Decodes an image, and returns its bytes in memory. A larger one that is there stays. */
  async addImage(file, bytes) {
    const bitmap = await createImageBitmap(new Blob([bytes]), bitmapOptions).catch((cause) => {
      throw new StreamError('corrupt', file.url, `the browser cannot read it: ${cause.message}; use another image`, {
        cause,
      });
    });
    const image = this.#front.images[file.number],
      place = image.files.indexOf(file);
    if (this.#disposed || place < image.shown) {
      bitmap.close();
      return 0;
    }
    for (const smaller of image.files.slice(0, place)) smaller.memory = 0;
    this.#setImage(file.number, bitmap);
    image.shown = place;
    return (bitmap.width * bitmap.height * 16) / 3;
  }

  #setImage(number, bitmap) {
    let before = null;
    for (const texture of this.#textures[number]) {
      before ??= texture.image;  // all of them share it
      texture.dispose();  // the next size needs other storage
      texture.image = bitmap;
      if (bitmap !== null) texture.needsUpdate = true;
    }
    if (before !== bitmap) before?.close();
  }

  removeImage(number) {
    this.#front.images[number].shown = -1;
    this.#setImage(number, null);
  }

  /** No file of an image can be shown: its materials are drawn without it. */
  dropImage(number) {
    for (const material of [...this.#materials, ...this.#final]) {
      for (const [name, texture] of texturesOf(material)) {
        if (!this.#textures[number].has(texture)) continue;
        material[name] = null;
        material.needsUpdate = true;
      }
    }
  }

  move(number, matrix) {
    const { matrix: own } = this.#front.draws[number];
    own.copy(matrix);
    for (const { meshes } of this.#pages.values()) {
      for (const mesh of meshes) if (mesh.matrix === own) mesh.matrixWorldNeedsUpdate = true;
    }
  }

  dispose() {
    this.#disposed = true;
    for (const file of Array.from(this.#pages.keys())) this.removePage(file);
    this.#textures.forEach((_, number) => this.removeImage(number));
    for (const material of [...this.#materials, ...this.#final]) material.dispose();
  }
}
