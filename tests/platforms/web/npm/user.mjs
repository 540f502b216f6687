// A project that has installed the package runs this. usage: user.mjs FILE.pvs
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { pathToFileURL } from "node:url";

import { Sightcell, SightcellError } from "sightcell";
import description from "sightcell/package.json" with { type: "json" };

import { openScene } from "./show.mjs";

const sightcell = await Sightcell.load();
const db = sightcell.open(readFileSync(process.argv[2]));
const view = db.createView();
const frame = view.move([0.5, 0.5, 0.5]);
let id = "ok";
try {
  sightcell.open(new Uint8Array(100));
} catch (error) {
  if (error instanceof SightcellError) id = error.id;
}
// The draws that the page of the README shows.
const shown = [];
const keys = db.draws.map((draw) => `${draw.node} ${draw.primitive} ${draw.instance}`);
const move = await openScene(pathToFileURL(process.argv[2]), (node, primitive, instance, visible) => {
  if (visible) shown.push(keys.indexOf(`${node} ${primitive} ${instance}`));
});
move({ x: 0.5, y: 0.5, z: 0.5 });
move({ x: 0.5, y: 0.5, z: 0.5 });
console.log(JSON.stringify({ version: description.version, cell: frame.cell, ranges: Array.from(view.ranges()), id, shown,
  wasm: createRequire(import.meta.url).resolve("sightcell/sightcell.wasm").endsWith("/sightcell/sightcell.wasm") }));
