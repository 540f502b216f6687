// The files of a streamed scene (docs/streaming.md): loads and checks them, reads the front and the cell chunks.
import { StreamError } from './error.js';

export const CHUNK = 0,
  PAGE = 1,
  IMAGE = 2;
export const ABSENT = 0,
  LOADING = 1,
  PRESENT = 2,
  FAILED = 3;

const folders = ['cells', 'pages', 'images'];
const extensions = ['png', 'jpg', 'webp', 'ktx2', 'bin'];
const sum = (numbers) => numbers.reduce((total, number) => total + number, 0);
const hex = (bytes) => Array.from(bytes, (byte) => byte.toString(16).padStart(2, '0')).join('');

export async function fetchBytes(url, init) {
  let response;
  try {
    response = await fetch(url, init);
    if (response.ok) return await response.arrayBuffer();
  } catch (cause) {
    if (cause.name === 'AbortError' || cause instanceof StreamError) throw cause;
    throw new StreamError('io', url, `${cause.message}; is the server reachable, and does it allow this origin?`, {
      cause,
    });
  }
  const gone = response.status === 404 || response.status === 410;
  throw new StreamError(
    gone ? 'absent' : 'io',
    url,
    `HTTP status ${response.status}${gone ? '; upload the whole site again' : ''}`,
  );
}

async function fetchOnce(file, init) {
  const bytes = await fetchBytes(file.url, init);
  if (bytes.byteLength !== file.bytes) {
    throw new StreamError('truncated', file.url, `${bytes.byteLength} bytes instead of ${file.bytes}; upload it again`);
  }
  const hash = new Uint8Array(await crypto.subtle.digest('SHA-256', bytes), 0, 8);
  if (hex(hash) !== file.hash)
    throw new StreamError('checksum', file.url, 'other contents than the front states; upload it again');
  return bytes;
}

/** The bytes of a file of the front, with the size and the hash that the front states. Other bytes are requested once
 * more, past the cache of the browser. */
export async function fetchFile(file, init) {
  try {
    return await fetchOnce(file, init);
  } catch (error) {
    if (error.id !== 'truncated' && error.id !== 'checksum') throw error;
    return fetchOnce(file, { ...init, cache: 'reload' });
  }
}

/** Reads a payload from its begin to its end. */
class Columns {
  #at = 0;

  static async inflate(packed, size, url) {
    const columns = new Columns(new Uint8Array(0), url);
    columns.need(size <= 1032 * packed.length, 'its size is wrong');  // zlib cannot reach more
    columns.data = new Uint8Array(size);
    const reader = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate')).getReader();
    let end = 0;
    for (;;) {
      const { done, value } = await reader.read().catch(({ message }) => columns.need(false, message));
      if (done) break;
      columns.need(end + value.length <= size, 'its zlib stream ends late');
      columns.data.set(value, end);
      end += value.length;
    }
    columns.need(end === size, 'its zlib stream ends early');
    return columns;
  }

  constructor(data, url) {
    Object.assign(this, { data, url });
  }

  need(condition, what) {
    if (!condition)
      throw new StreamError('corrupt', this.url, `it is damaged: ${what}; pack and upload the scene again`);
  }

  bytes(count) {
    this.#at += count;
    this.need(this.#at <= this.data.length, 'its payload ends early');
    return this.data.subarray(this.#at - count, this.#at);
  }

  varint(below = 2 ** 32) {
    let value = 0,
      scale = 1,
      part;
    do {
      part = this.data[this.#at++];
      value += (part & 127) * scale;
      scale *= 128;
    } while (part > 127 && scale < 2 ** 35);
    this.need(part < 128 && (part > 0 || scale === 128) && value < below, 'a number is out of range');
    return value;
  }

  /** `next` makes the next element of a column. A loop is the fastest way in a page that has just begun. */
  column(count, next) {
    this.need(count <= this.data.length - this.#at, 'a table is longer than its payload');
    const values = [];
    for (let i = 0; i < count; ++i) values.push(next(i));
    return values;
  }

  varints(count, below = 2 ** 32) {
    return this.column(count, () => {
      const byte = this.data[this.#at];
      if (!(byte < 128 && byte < below)) return this.varint(below);
      ++this.#at;
      return byte;
    });
  }

  deltas(count, below = 2 ** 32) {
    let value = 0;
    return this.varints(count).map((code) => {
      value += code % 2 ? -(code + 1) / 2 : code / 2;
      this.need(value >= 0 && value < below, 'a number is out of range');
      return value;
    });
  }

  gaps(count, below) {
    let value = -1;
    return this.varints(count).map((gap) => {
      value += gap + 1;
      this.need(value < below, 'a number is out of range');
      return value;
    });
  }

  floats(count) {
    const planes = this.bytes(4 * count),
      values = new Float32Array(count),
      bits = new Uint32Array(values.buffer);
    for (let i = 0; i < count; ++i) {
      const low = planes[i] | (planes[i + count] << 8);
      bits[i] = low | (planes[i + 2 * count] << 16) | (planes[i + 3 * count] << 24);
      this.need(((bits[i] >> 23) & 255) !== 255, 'a float is not finite');
    }
    return values;
  }

  boxes(count) {
    const columns = Array.from({ length: 6 }, () => this.floats(count));
    return Array.from({ length: count }, (_, i) => this.box(columns.map((column) => column[i])));
  }

  box(ends) {
    this.need(
      ends[0] <= ends[3] && ends[1] <= ends[4] && ends[2] <= ends[5],
      'a box has its minimum above its maximum',
    );
    return ends;
  }

  files(kind, sizes, site, extension) {
    const hashes = this.bytes(8 * sizes.length);
    return sizes.map((bytes, i) => {
      const hash = hex(hashes.subarray(8 * i, 8 * i + 8));
      const url = new URL(`${folders[kind]}/${hash}.${extension(i)}`, site).href;
      return { kind, number: i, bytes, hash, url, state: ABSENT, needed: 0, wanted: 0, memory: 0, failures: 0 };
    });
  }

  end() {
    this.need(this.#at === this.data.length, 'its payload ends late');
  }
}

/** polygons: of each geometry. materials: how many there are. */
function readDraws(read, count, polygons, materials) {
  const geometry = read.deltas(count, polygons.length),
    material = read.varints(count, materials + 1);
  const flags = read.varints(count, 8),
    object = read.varints(count),
    level = read.varints(count);
  const node = read.deltas(count),
    mesh = read.deltas(count),
    instance = read.deltas(count);
  const primitive = read.varints(count),
    columns = [];
  for (let k = 0; k < 12; ++k) columns.push(read.floats(count));
  const draws = geometry.map((_, i) => {
    read.need((flags[i] & 6) !== 6, 'a draw is in every cell and in none');
    return {
      number: i,
      geometry: geometry[i],
      material: material[i],
      flags: flags[i],
      object: object[i],
      level: level[i],
      node: node[i],
      mesh: mesh[i],
      instance: instance[i],
      primitive: primitive[i],
    };
  });
  return { draws, columns };
}

function readPages(read, count, box, url) {
  const files = read.files(PAGE, read.varints(count), url, () => 'glb');
  const steps = read.bytes(6 * count);
  const end = (k, step) => box[k] + ((box[k + 3] - box[k]) * step) / 255;
  files.forEach((page, i) => {
    page.box = read.box(box.map((_, k) => end(k % 3, steps[k * count + i])));
  });
  return files;
}

function readImages(read, count, fileCount, url) {
  const counts = read.varints(count);
  const [widths, heights, sizes] = [0, 1, 2].map(() => read.varints(fileCount));
  const types = Array.from(read.bytes(fileCount), (type) => extensions[type]);
  read.need(!types.includes(undefined), 'an image has an unknown type');
  const files = read.files(IMAGE, sizes, url, (i) => types[i]);
  files.forEach((file, i) => Object.assign(file, { width: widths[i], height: heights[i], type: types[i] }));
  let first = 0;
  const images = counts.map((own, number) => {
    first += own;
    const list = files.slice(first - own, first);
    for (const file of list) file.number = number;
    return { files: list, shown: -1 };
  });
  read.need(first === fileCount, 'its images have other files');
  return images;
}

function readChunks(read, count, cells, url) {
  const sizes = read.varints(count),
    counts = read.varints(count);
  const files = read.files(CHUNK, sizes, url, () => 'cells');
  read.boxes(count).forEach((box, i) => Object.assign(files[i], { box, count: counts[i], cells: null }));
  read.need(sum(counts) === cells, 'its chunks have other cells');
  return files;
}

/** url: the folder of the site, or its front. */
export async function openFront(url, init) {
  const path = String(url).replace(/\/?(scene\.front)?$/, '/scene.front');
  const front = new URL(path, globalThis.document?.baseURI).href;
  if (globalThis.crypto?.subtle === undefined) {
    throw new StreamError('absent', front, 'this page cannot check files; serve it over https, or from localhost');
  }
  return readFront(await fetchBytes(front, { cache: 'no-cache', ...init }), front);
}

export async function readFront(bytes, url) {
  const data = new Uint8Array(bytes);
  if (String.fromCharCode(...data.subarray(0, 8)) !== 'SIGHTFRT') {
    throw new StreamError('not_ours', url, 'no scene.front; name the folder that sightcell pack --stream has written');
  }
  if (data.length < 16) throw new StreamError('truncated', url, 'it is cut; upload it again');
  const header = new DataView(bytes);
  if (header.getUint32(8, true) !== 1) {
    throw new StreamError(
      'version',
      url,
      `version ${header.getUint32(8, true)}, this package reads 1; use the version that packed it`,
    );
  }
  const read = await Columns.inflate(data.subarray(16), header.getUint32(12, true), url);
  const fingerprint = hex(read.bytes(16));
  const [polygons, geometries, draws, pages, images, files, chunks, cells, text] = read.varints(9);
  const box = read.box(Array.from(read.floats(6)));
  let json;
  try {
    json = JSON.parse(new TextDecoder().decode(read.bytes(text)) || '{}');
  } catch ({ message }) {
    read.need(false, message);
  }
  read.need(json instanceof Object, 'its JSON is no object');
  const geometryPolygons = read.varints(geometries);
  const { draws: listed, columns } = readDraws(read, draws, geometryPolygons, json.materials?.length ?? 0);
  const drawn = sum(listed.map(({ geometry }) => geometryPolygons[geometry]));
  read.need(drawn === polygons, `its draws have ${drawn} polygons of ${polygons}`);
  const pageFiles = readPages(read, pages, box, url);
  const imageList = readImages(read, images, files, url);
  const chunkFiles = readChunks(read, chunks, cells, url);
  const everywhere = { pages: read.gaps(read.varint(), pages), images: read.gaps(read.varint(), images) };
  read.end();
  return {
    url,
    fingerprint,
    polygons,
    box,
    json,
    geometries,
    draws: listed,
    columns,  // of their matrices
    pages: pageFiles,
    images: imageList,
    chunks: chunkFiles,
    files: [...chunkFiles, ...pageFiles, ...imageList.flatMap((image) => image.files)],
    everywhere,
  };
}

export async function readChunk(bytes, file, front) {
  const read = await Columns.inflate(
    new Uint8Array(bytes, Math.min(4, bytes.byteLength)),
    bytes.byteLength < 4 ? 0 : new DataView(bytes).getUint32(0, true),
    file.url,
  );
  const n = read.varint();
  read.need(n === file.count, `it has ${n} cells of ${file.count}`);
  const numbers = read.deltas(n),
    boxes = read.boxes(n),
    weights = read.floats(n);
  const perCell = (counts, next) => counts.map(next);
  const pages = perCell(read.varints(n), (count) => read.gaps(count, front.pages.length));
  const shares = perCell(pages, (list) => read.bytes(list.length));
  const headings = perCell(pages, (list) => read.bytes(list.length));
  const runs = perCell(read.varints(n), (count) => {
    let end = 0;
    return read.column(count, () => {
      const begin = end + read.varint();
      end = begin + read.varint() + 1;
      read.need(end <= front.draws.length, 'a draw does not exist');
      return [begin, end];
    });
  });
  const images = perCell(read.varints(n), (count) => read.gaps(count, front.images.length));
  const imageShares = perCell(images, (list) => read.bytes(list.length));
  read.end();
  read.need(
    weights.every((weight) => weight >= 0),
    'a weight is negative',
  );
  return numbers.map((number, i) => ({
    number,
    box: boxes[i],
    weight: weights[i],
    pages: pages[i],
    shares: shares[i],
    headings: headings[i],
    runs: runs[i],
    images: images[i],
    imageShares: imageShares[i],
  }));
}
