// What docs/hosting.md shows of a page, with a page around it: check_readme.py holds the text against what lies between
// the markers. page_test.mjs runs it.

/* [page */
export async function open_scene(base, stored_indices) {
  const { instance } = await WebAssembly.instantiateStreaming(fetch(new URL("sightcell.wasm", base)));
  const file = new Uint8Array(await (await fetch(new URL("scene.pvs", base))).arrayBuffer());
  const sc = instance.exports;
  const u32 = (at, count) => new Uint32Array(sc.memory.buffer, at, count);  // anew each time: memory may have grown
  const room = sc.malloc(80), bytes = sc.malloc(file.length);  // room: a frame, an eye, a result
  const frame = room, eye = room + 64, out = room + 76;
  new Uint8Array(sc.memory.buffer, bytes, file.length).set(file);
  if (sc.sightcell_db_open(bytes, file.length, 0, out) !== 0) return null;  // draw everything
  const db = u32(out, 1)[0];
  if (sc.sightcell_view_create(db, out) !== 0) return null;
  const view = u32(out, 1)[0];
  const indices = stored_indices(sc, db), most = indices.length;  // all of them, permuted by sightcell_db_order as above
  const stored = sc.malloc(4 * most), list = sc.malloc(4 * most);
  u32(stored, most).set(indices);
  return (x, y, z) => {  // every frame: null, or the new index list for gl.bufferSubData
    new Float32Array(sc.memory.buffer, eye, 3).set([x, y, z]);
    sc.sightcell_view_move(view, eye, frame);
    if ((u32(frame, 2)[1] & 1) === 0) return null;  // SIGHTCELL_FRAME_CHANGED
    sc.sightcell_view_indices(view, stored, list, most, out);
    return u32(list, u32(out, 1)[0]);
  };
}
/* page] */
