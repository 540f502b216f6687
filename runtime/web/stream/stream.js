// A streaming client for three.js. See stream.d.ts for what each function does.
import { Group } from 'three';
import { CameraView } from './camera_view.js';
import { Cells, CELL } from './cells.js';
import { StreamError } from './error.js';
import { ABSENT, CHUNK, FAILED, fetchFile, IMAGE, LOADING, openFront, PAGE, PRESENT, readChunk } from './format.js';
import { StreamedScene } from './scene.js';

export { StreamError } from './error.js';

const relistAfter = 100;  // milliseconds of movement between two lists of requests
const aheadAge = 10000;  // milliseconds for which files that were loaded ahead are kept
const slowest = 2;  // bytes per millisecond of a transfer that is not given up
const stall = 30000;  // milliseconds, in addition
const firstBackoff = 250,
  longestBackoff = 8000;  // milliseconds
const reportAfter = 4;  // failed attempts

function estimate({ kind, bytes, width, height }) {
  if (kind === CHUNK) return 0;
  return kind === IMAGE && width > 0 ? (width * height * 16) / 3 : 8 * bytes;
}

class Stream {
  group = new Group();
  #front;
  #cells;
  #scene = null;
  #view;
  #begun = false;  // there is a camera
  #opened = false;  // the page has what stream() returns
  #options;
  #queue = [];  // in the opposite order
  #stamp = 0;
  #stale = true;  // the queue
  #moved = false;
  #listed = 0;  // time of the queue
  #inFlight = new Set();
  #memory = 0;
  #sums;
  #disposed = false;

  static async open(front, scene, camera, options) {
    const made = new Stream(front, options);
    scene.add(made.group);
    made.update(camera);  // requests cells before materials are made
    made.#scene = new StreamedScene(front, made.group, options);
    made.#show();
    try {
      await made.#scene.ready;
    } catch (error) {
      made.dispose();
      throw error;
    }
    made.#opened = true;
    return made;
  }

  constructor(front, options) {
    this.#front = front;
    this.#cells = new Cells(front);
    this.#options = options;
    this.#view = new CameraView(options.lookahead);
    this.#sums = this.#cells.count();
  }

  get draws() {
    return this.#front.draws;
  }
  get cell() {
    return this.#cells.cell?.number ?? -1;
  }
  get outside() {
    return this.#cells.outside;
  }
  get complete() {
    return !this.#cells.unknown && this.#sums.missing === 0;
  }
  get failed() {
    return this.#sums.failed;
  }
  get weight() {
    return this.#sums.weight;
  }
  get progress() {
    return this.#sums.weight > 0 ? this.#sums.present / this.#sums.weight : Number(this.complete);
  }
  get clearDistance() {
    return this.#cells.clearDistance(this.#view.eye);
  }
  get memoryBytes() {
    return this.#memory;
  }

  update(camera) {
    if (this.#disposed) throw new StreamError('disposed', this.#front.url, 'update() after dispose()');
    const now = performance.now();
    if (this.#view.move(camera, this.group, now)) {
      const isFirst = !this.#begun;
      this.#moved = this.#begun = true;
      if (this.#cells.move(this.#view.eye) || isFirst) this.#settle(true);
    }
    if (!this.#moved || now - this.#listed < relistAfter) return;
    this.#stale = true;
    this.#pump();
  }

  moveDraw(draw, matrix) {
    this.#scene.move(draw, matrix);
  }

  dispose() {
    if (this.#disposed) return;
    this.#disposed = true;
    for (const file of this.#front.files) {
      clearTimeout(file.timer);
      file.abort?.abort();
    }
    this.#scene?.dispose();
    this.group.removeFromParent();
    this.#memory = 0;
  }

  /** After a file has changed, or the cell. */
  #settle(cellChanged) {
    const { complete } = this.#cells;
    this.#sums = this.#cells.count();
    if (cellChanged || complete !== this.#cells.complete) {
      this.#show();
      this.#makeRoom(0, 0);  // for what the last complete cell did not leave
    }
    this.#stale ||= cellChanged;
    this.#pump();
    if (this.#opened) this.#options.onChange();
  }

  #show() {
    if (this.#scene === null) return;
    const { shown } = this.#scene;
    this.#front.draws.forEach(({ flags }, i) => {
      shown[i] = (flags >> 1) & 1;
    });
    for (const cell of [this.#cells.cell, this.#cells.complete]) {
      for (const [begin, end] of cell?.runs ?? []) shown.fill(1, begin, end);
    }
    this.#scene.apply();
  }

  #pump() {
    if (this.#disposed || !this.#begun) return;
    if (this.#stale) {
      this.#view.look();
      const { list, stamp } = this.#cells.requests(this.#view);
      this.#queue = list.reverse();
      this.#stamp = stamp;
      this.#stale = this.#moved = false;
      this.#listed = performance.now();
    }
    const isUrgent = ({ reason }) => reason <= CELL;
    while (this.#queue.length > 0 && this.#inFlight.size < this.#options.requests) {
      const file = this.#queue.pop();
      if (file.state !== ABSENT) continue;
      const fits = this.#makeRoom(estimate(file), isUrgent(file) ? 0 : aheadAge);
      if (fits || isUrgent(file)) this.#load(file);  // a cell that is larger than the limit is loaded nevertheless
    }
    if (!this.#queue.some((file) => file.state === ABSENT && isUrgent(file))) return;
    for (const file of this.#inFlight) if (file.wanted !== this.#stamp) file.abort.abort();
  }

  #account(file, bytes) {
    this.#memory += bytes - file.memory;
    file.memory = bytes;
  }

  #makeRoom(bytes, age) {
    const { memory } = this.#options;
    if (this.#memory + bytes <= memory) return true;
    const now = performance.now();
    for (const file of this.#cells.removable()) {
      if (this.#memory + bytes <= memory) break;
      if (file.state === PRESENT && now - file.since >= age) this.#remove(file);
    }
    return this.#memory + bytes <= memory;
  }

  #remove(file) {
    const gone = [file];
    if (file.kind === PAGE) {
      this.#scene.removePage(file);
    } else {
      // The smaller versions, which it has replaced, are gone too.
      const { files, shown } = this.#front.images[file.number];
      if (files[shown] !== file) return;
      gone.push(...files.slice(0, shown).filter(({ state }) => state === PRESENT));
      this.#scene.removeImage(file.number);
    }
    for (const each of gone) {
      this.#account(each, 0);
      each.state = ABSENT;
    }
  }

  async #load(file) {
    file.state = LOADING;
    file.abort = new AbortController();
    this.#account(file, estimate(file));
    let error = null,
      size = 0;
    try {
      size = await this.#take(file, await this.#transfer(file));
    } catch (thrown) {
      error = thrown;
    }
    if (this.#disposed) return;
    this.#account(file, size);
    if (error === null) {
      file.state = PRESENT;
      file.failures = 0;
      file.since = performance.now();
    } else {
      this.#fail(file, error);
    }
    this.#stale ||= file.kind === CHUNK || this.#queue.length === 0;
    if (file.kind === IMAGE) this.#scene.apply();
    this.#settle(file.kind === CHUNK && this.#cells.move(this.#view.eye));
  }

  async #transfer(file) {
    if (file.type === 'ktx2')
      throw new StreamError('limit', file.url, 'KTX2 images are not read; use PNG, JPEG or WebP');
    const { abort, reason } = file;
    const timer = setTimeout(
      () => abort.abort(new StreamError('io', file.url, 'the transfer has stalled')),
      stall + file.bytes / slowest,
    );
    this.#inFlight.add(file);
    try {
      const priority = reason <= CELL ? 'high' : 'low';
      return await fetchFile(file, { ...this.#options.init, signal: abort.signal, priority });
    } finally {
      clearTimeout(timer);
      this.#inFlight.delete(file);
      this.#pump();
    }
  }

  async #take(file, bytes) {
    await this.#scene.ready;
    if (file.kind === CHUNK) file.cells = await readChunk(bytes, file, this.#front);
    return file.kind === PAGE
      ? this.#scene.addPage(file, bytes)
      : file.kind === IMAGE
        ? this.#scene.addImage(file, bytes)
        : 0;
  }

  #fail(file, error) {
    const { aborted, reason } = file.abort.signal;
    file.state = ABSENT;
    if (aborted && reason?.name === 'AbortError') return;  // no longer needed
    if (error.id === 'io') {
      file.state = LOADING;
      if (++file.failures === reportAfter) this.#options.onError(error);
      const again = () => {
        file.state = ABSENT;
        this.#stale = true;
        this.#pump();
      };
      file.timer = setTimeout(again, Math.min(firstBackoff * 2 ** (file.failures - 1), longestBackoff));
      return;
    }
    file.state = FAILED;
    this.#stale = true;
    if (file.kind === IMAGE && this.#cells.settled(file.number) && this.#front.images[file.number].shown < 0) {
      this.#scene.dropImage(file.number);
    }
    this.#options.onError(error);
  }
}

const nothing = () => {};
const defaults = {
  memory: 256 * 2 ** 20,
  lookahead: 2,
  workers: 1,
  init: {},
  onChange: nothing,
  onMesh: nothing,
  onError: ({ message }) => console.warn(message),
};

export async function stream(url, scene, camera, options = {}) {
  const settings = { ...defaults, ...options };
  const front = await openFront(url, settings.init);
  const [timing] = performance.getEntriesByName(front.url);
  settings.requests ??= /^h[23]/.test(timing?.nextHopProtocol) ? 24 : 8;
  return Stream.open(front, scene, camera, settings);
}
