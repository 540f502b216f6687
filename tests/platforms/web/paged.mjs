// A paged file: the module calls a function of the page for each piece. The module can call WebAssembly functions only, so
// a small WebAssembly function in the module's table forwards the call.
import { status } from "./host.mjs";

// (module (import "p" "f" (func (param i32 i64 i32 i32) (result i32))) (export "f" (func 0)))
const between = new Uint8Array([0, 97, 115, 109, 1, 0, 0, 0, 1, 9, 1, 96, 4, 127, 126, 127, 127, 1, 127,
  2, 7, 1, 1, 112, 1, 102, 0, 0, 7, 5, 1, 1, 102, 0, 0]);

function number_of(table, request) {
  const { exports } = new WebAssembly.Instance(new WebAssembly.Module(between), { p: { f: request } });
  table.grow(1);
  table.set(table.length - 1, exports.f);
  return table.length - 1;
}

// The whole file may be resident. Delivers each piece immediately.
export function open_paged(host, file) {
  const { c } = host;
  let requests = 0;
  const db = host.room(4);
  const request = (user, offset, size, ticket) => {
    ++requests;
    const at = host.put(file.subarray(Number(offset), Number(offset) + size));
    const s = c.sightcell_db_deliver(host.u32(db, 1)[0], ticket, at, size);
    c.free(at);
    return s;
  };
  const source = host.room(24);
  host.data(source, 24).setUint32(0, 0, true);
  host.data(source, 24).setBigUint64(8, BigInt(file.length), true);
  host.data(source, 24).setUint32(16, number_of(c.__indirect_function_table, request), true);
  const s = c.sightcell_db_open_source(source, 0, BigInt(file.length), db);
  c.free(source);
  const opened = host.u32(db, 1)[0];
  if (s === status.ok) {
    const eye = host.put(new Float32Array(6));
    const asked = c.sightcell_db_prefetch(opened, eye, eye + 12, 1.0);
    c.free(eye);
    if (asked !== status.ok) throw new Error(`prefetch: ${asked}`);
  }
  return {
    db: opened,
    status: s,
    requests: () => requests,
    close() {
      c.sightcell_db_close(opened);
      c.free(db);
    },
  };
}
