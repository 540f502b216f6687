// The module as a host uses it: its memory, and lists whose size is requested before their content.
import { readFileSync } from "node:fs";

export const status = { ok: 0, argument: 1, memory: 2, capacity: 3, stale: 4, io: 10, not_ours: 20, version: 21,
  truncated: 22, checksum: 23, corrupt: 24, limit: 25, other_scene: 26 };

export function require(good, what) {
  if (!good) throw new Error(what);
}

// Whether a record of the section table has the id of clusters and the required flag. The module is built without them.
export function requires_clusters(file) {
  for (let at = 96; at + 8 <= file.length && at < 96 + 32 * file.readUInt32LE(12); at += 32)
    if (file.readUInt32LE(at) === 16 && file.readUInt32LE(at + 4) === 1) return true;
  return false;
}

export class host {
  static async load(path) {
    const { instance } = await WebAssembly.instantiate(readFileSync(path));
    return new host(instance.exports);
  }

  constructor(exports) {
    this.c = exports;
    this.out = exports.malloc(16);  // functions write single numbers here
  }

  // Made for each use, because views of the memory become empty when the memory grows.
  bytes(at, size) { return new Uint8Array(this.c.memory.buffer, at, size); }
  u32(at, count) { return new Uint32Array(this.c.memory.buffer, at, count); }
  f32(at, count) { return new Float32Array(this.c.memory.buffer, at, count); }
  f64(at, count) { return new Float64Array(this.c.memory.buffer, at, count); }
  data(at, size) { return new DataView(this.c.memory.buffer, at, size); }
  written() { return this.u32(this.out, 1)[0]; }

  // Allocates memory, which the caller frees.
  room(size) {
    const at = this.c.malloc(size);
    require(at !== 0 && at % 16 === 0, `malloc(${size}) gave ${at}`);
    return at;
  }
  put(array) {
    const at = this.room(Math.max(array.byteLength, 1));
    this.bytes(at, array.byteLength).set(new Uint8Array(array.buffer, array.byteOffset, array.byteLength));
    return at;
  }
  text(at) {
    let end = at;
    while (this.bytes(end, 1)[0] !== 0) ++end;
    return new TextDecoder().decode(this.bytes(at, end - at));
  }

  // Returns a copy of the bytes that fill(dst, capacity, count) writes. size: bytes of one element.
  list(size, fill) {
    const asked = fill(0, 0, this.out);
    const count = this.written();
    require(asked === (count === 0 ? status.ok : status.capacity), `a list's size: status ${asked}`);
    const at = this.room(size * count + 1);
    const s = fill(at, count, this.out);
    require(s === status.ok && this.written() === count, `a list: status ${s}`);
    const copy = this.bytes(at, size * count).slice();
    this.c.free(at);
    return copy;
  }
  list_u32(words, fill) { return new Uint32Array(this.list(4 * words, fill).buffer); }

  // Opens a file from a path or from bytes, calls use({db, status}), and frees everything.
  with_file(file, use) {
    const array = typeof file === "string" ? readFileSync(file) : file;
    const at = this.put(array);
    const s = this.c.sightcell_db_open(at, array.length, 0, this.out);
    const db = this.written();
    require((s === status.ok) === (db !== 0), `status ${s} with db ${db}`);
    const result = use({ db, status: s, at, size: array.length });
    this.c.sightcell_db_close(db);
    this.c.free(at);
    return result;
  }
  with_view(db, use) {
    require(this.c.sightcell_view_create(db, this.out) === status.ok, "no view");
    const view = this.written();
    const result = use(view);
    this.c.sightcell_view_destroy(view);
    return result;
  }
}

// FNV-1a of 64 bits, as tests/platforms/decode_dump.h has it.
export class fnv_hash {
  value = 0xCBF29CE484222325n;
  add_byte(byte) { this.value = BigInt.asUintN(64, (this.value ^ BigInt(byte)) * 0x100000001B3n); }
  add_text(text) { for (let i = 0; i < text.length; ++i) this.add_byte(text.charCodeAt(i)); }
  add(number) { for (let shift = 0; shift < 32; shift += 8) this.add_byte(number >>> shift & 0xFF); }
  hex() { return this.value.toString(16).padStart(16, "0"); }
}
