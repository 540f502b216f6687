// The memory of the module: blocks in it, typed arrays over it, and the structs of sightcell.h in it.
import { badArgument, SightcellError } from './error.js';
import { constants, structs } from './layout.js';

const readers = {
  u8: (data, at) => data.getUint8(at),
  u32: (data, at) => data.getUint32(at, true),
  u64: (data, at) => data.getBigUint64(at, true),
  f32: (data, at) => data.getFloat32(at, true),
  f64: (data, at) => data.getFloat64(at, true),
};
const widths = { u8: 1, u32: 4, u64: 8, f32: 4, f64: 8 };

const camelCase = (name) => name.replace(/_(.)/g, (_, letter) => letter.toUpperCase());

export class Heap {
  constructor(exports) {
    this.c = exports;
    this.views = null;
    // Where functions write their results: two positions, an origin and the numbers of lists.
    this.scratch = this.allocate(64);
    this.text = new TextDecoder();
  }

  // Typed arrays over the memory lose their elements when the memory grows, so they are made again then.
  get u8() { return this.current().u8; }
  get u32() { return this.current().u32; }
  get f32() { return this.current().f32; }
  get f64() { return this.current().f64; }
  get data() { return this.current().data; }

  current() {
    const { buffer } = this.c.memory;
    if (this.views === null || this.views.u8.buffer !== buffer) {
      this.views = {
        u8: new Uint8Array(buffer),
        u32: new Uint32Array(buffer),
        f32: new Float32Array(buffer),
        f64: new Float64Array(buffer),
        data: new DataView(buffer),
      };
    }
    return this.views;
  }

  /** The address of a new block at a multiple of 16. The caller frees it. */
  allocate(size) {
    const at = this.c.malloc(size) >>> 0;
    if (at === 0) throw new SightcellError('memory', `sightcell: the module has no ${size} bytes left`);
    return at;
  }

  free(at) { this.c.free(at); }

  /** A block with a copy of these bytes. */
  put(bytes) {
    const at = this.allocate(bytes.byteLength);
    this.u8.set(bytes, at);
    return at;
  }

  /** Calls use(address) with a block that is freed afterwards. */
  borrow(size, use) {
    const at = this.allocate(size);
    try {
      return use(at);
    } finally {
      this.free(at);
    }
  }

  /** Writes a point: [x, y, z], a typed array, or an object with x, y and z, such as a vector of three.js. */
  putPoint(numbers, at, point, what) {
    for (let axis = 0; axis < 3; ++axis) {
      const value = point?.[axis] ?? point?.['xyz'[axis]];
      if (typeof value !== 'number') throw badArgument(`${what} takes points: three numbers, or an object with x, y and z`);
      numbers[at + axis] = value;
    }
  }

  /** English text for a status. */
  statusText(status) {
    const begin = this.c.sightcell_status_text(status) >>> 0;
    return this.text.decode(this.u8.subarray(begin, this.u8.indexOf(0, begin)));
  }

  require(status, what) {
    if (status !== constants.OK) throw SightcellError.ofStatus(status, what, this.statusText(status));
  }

  /** The number that a function wrote to the scratch block, at this word of it. */
  written(word = 0) { return this.u32[this.scratch / 4 + word]; }

  /** Reads a list whose length is asked for first: fill(address, capacity, address of the count) returns a status.
   * size: bytes of one element; use(address, count) returns the result. */
  list(size, what, fill, use) {
    const asked = fill(0, 0, this.scratch);
    if (asked !== constants.ERR_CAPACITY) this.require(asked, what);
    const count = this.written();
    return this.borrow(size * count, (at) => {
      this.require(fill(at, count, this.scratch), what);
      return use(at, count);
    });
  }

  /** A copy of a list of 32-bit numbers. */
  listOfWords(what, fill) {
    return this.list(4, what, fill, (at, count) => this.u32.slice(at / 4, at / 4 + count));
  }

  /** The members of a struct in the memory, in camel case. More than one number becomes an array. */
  read(name, at) {
    const result = {};
    const { data } = this;
    for (const [member, { at: offset, kind, count = 1 }] of Object.entries(structs[name].members)) {
      if (member === 'struct_size' || member === 'reserved') continue;
      const numbers = Array.from({ length: count }, (_, i) => readers[kind](data, at + offset + widths[kind] * i));
      result[camelCase(member)] = count === 1 ? numbers[0] : numbers;
    }
    return result;
  }

  /** Fills a struct that begins with its own size: call(address) returns a status. */
  readSized(name, what, call) {
    const { size, members } = structs[name];
    return this.borrow(size, (at) => {
      this.u32[(at + members.struct_size.at) / 4] = size;
      this.require(call(at), what);
      return this.read(name, at);
    });
  }
}
