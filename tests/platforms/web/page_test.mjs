// Serves and runs the page of docs/hosting.md. Its index lists must be those of the cells on its way.
// usage: page_test.mjs MODULE.wasm FILE.pvs FILE.txt
import { readFileSync } from "node:fs";
import { createServer } from "node:http";

import { require } from "./host.mjs";
import { open_scene } from "./page.mjs";

const [module_path, file, text] = process.argv.slice(2);
const served = {
  "/sightcell.wasm": ["application/wasm", readFileSync(module_path)],
  "/scene.pvs": ["application/octet-stream", readFileSync(file)],
};
const server = createServer((request, response) => {
  const [type, bytes] = served[request.url] ?? ["text/plain", ""];
  response.setHeader("Content-Type", type).end(bytes);
});
await new Promise((listening) => server.listen(0, "127.0.0.1", listening));
const base = `http://127.0.0.1:${server.address().port}/`;

// The three indices of each polygon encode its source id, so that a list shows which polygons it has.
const stored_indices = (sc, db) => {
  const polygons = sc.sightcell_db_polygon_count(db);
  const out = sc.malloc(4 + 4 * polygons);
  require(sc.sightcell_db_order(db, out + 4, polygons, out) === 0, "no order");
  const order = Array.from(new Uint32Array(sc.memory.buffer, out + 4, polygons));
  sc.free(out);
  sc.free(sc.malloc(1 << 22));  // the memory grows
  return order.flatMap((source) => [3 * source, 3 * source + 1, 3 * source + 2]);
};

try {
  const move = await open_scene(base, stored_indices);
  require(move !== null, "the page draws everything");
  let cells = 0;
  for (const line of readFileSync(text, "utf8").split("\n").filter((each) => each.startsWith("cell "))) {
    const [, min, max, sees] = line.match(/: (.*)  (.*)  sees(.*)/);
    const [low, high] = [min, max].map((ends) => ends.split(" ").map(Number));
    const eye = low.map((end, axis) => 0.5 * (end + high[axis]));
    move(1e6, 1e6, 1e6);  // outside, so that each cell is a change
    const polygons = sees.trim() === "" ? [] : sees.trim().split(" ").map(Number);
    const list = Array.from(move(...eye)).sort((a, b) => a - b);
    require(list.join() === polygons.flatMap((p) => [3 * p, 3 * p + 1, 3 * p + 2]).join(), `${line}\n${list}`);
    require(move(...eye) === null, "nothing changed");
    ++cells;
  }
  require(cells > 1, "too few cells");
  console.log(`${cells} cells`);
} finally {
  server.close();
  server.closeAllConnections();
}
