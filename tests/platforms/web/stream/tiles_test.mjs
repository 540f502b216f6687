// The plugin for 3d-tiles-renderer in node, with what it uses of a renderer: which tiles are visible, in which order.
// usage: tiles_test.mjs PACKAGE_FOLDER SITE_FOLDER THREE_FOLDER
import { readFileSync } from "node:fs";
import { join } from "node:path";

import { require } from "../host.mjs";
import { FakeServer, base, clock, pause, project_of, until } from "./fake_web.mjs";

const [folder, sites, three] = process.argv.slice(2);
const { load } = project_of(folder, three);
const THREE = await load("three/build/three.module.js");
const { CellTilesPlugin } = await load("sightcell-stream/tiles.js");
const site = JSON.parse(readFileSync(join(sites, "rooms.json"), "utf8"));
const rooms = [0, 1, 2].map((i) => new THREE.Vector3(9 * i + 6, 2, 6));

function leaves_of(tile) {
  return tile.children === undefined ? [tile] : tile.children.flatMap(leaves_of);
}

class FakeRenderer extends THREE.EventDispatcher {
  group = new THREE.Group();
  cameras = [new THREE.PerspectiveCamera(60, 16 / 9, 0.05, 1000)];
  downloadQueue = { priorityCallback: (a, b) => a.place - b.place };
  updates = 0;

  constructor() {
    super();
    const { root } = JSON.parse(readFileSync(join(sites, "rooms.site", "tileset.json"), "utf8"));
    this.root = root;
    this.group.rotation.x = -Math.PI / 2;
    this.leaves = leaves_of(root);
    this.leaves.forEach((tile, place) => Object.assign(tile, { place, internal: { renderer: this } }));
    this.addEventListener("needs-update", () => ++this.updates);
  }

  go(eye) {
    clock.skipped += 1000;
    this.cameras[0].position.copy(eye);
    this.dispatchEvent({ type: "update-before" });
  }

  page(number) {
    return this.leaves.find(({ extras }) => extras.sightcell.page === number);
  }
}

const pages_of = (cell) => [0, ...site.cells[cell].pages].sort();
const visible = (tiles, plugin) =>
  tiles.leaves
    .filter((tile) => plugin.visible(tile))
    .map(({ extras }) => extras.sightcell.page)
    .sort();
const same = (found, expected, what) =>
  require(found.join() === expected.join(), `${what}: ${found} instead of ${expected}`);

async function cells_choose_the_tiles() {
  const server = new FakeServer(join(sites, "rooms.site"));
  const tiles = new FakeRenderer(),
    errors = [];
  const plugin = new CellTilesPlugin(base, { onError: (error) => errors.push(error) });
  const { priorityCallback: before } = tiles.downloadQueue;
  plugin.init(tiles);
  same(visible(tiles, plugin), [], "before the front is there");
  await until(() => tiles.updates > 0, "the front");
  tiles.go(rooms[1]);
  tiles.go(rooms[0]);
  await until(() => plugin.cell === 0, "the chunk");
  same(server.names(), ["scene.front", site.chunks[0].url], "requests");
  same(visible(tiles, plugin), pages_of(0), "the first room");
  require(!plugin.complete, "complete without a tile");
  for (const page of pages_of(0)) tiles.dispatchEvent({ type: "load-model", tile: tiles.page(page) });
  require(plugin.complete, "all tiles are loaded");

  // The tiles of the last complete cell stay until those of the next one are there.
  tiles.go(rooms[2]);
  require(plugin.cell === 2 && !plugin.complete, `cell ${plugin.cell}`);
  same(visible(tiles, plugin), [...new Set([...pages_of(0), ...pages_of(2)])].sort(), "both rooms");
  const [failing, ...others] = site.cells[2].pages;
  for (const page of others) tiles.dispatchEvent({ type: "load-model", tile: tiles.page(page) });
  tiles.dispatchEvent({ type: "load-error", tile: null });
  const is_there = pages_of(0).includes(failing);
  require(plugin.complete === is_there, "the last tile");
  tiles.dispatchEvent({ type: "load-error", tile: tiles.page(failing) });
  require(plugin.complete, "but for a tile that has failed");
  same(visible(tiles, plugin), pages_of(2), "the third room");

  // What the renderer asks, for empty tiles too.
  const target = { inView: true, error: 0 };
  const has_visible = (tile) => leaves_of(tile).some((leaf) => pages_of(2).includes(leaf.extras.sightcell.page));
  let masked = 0;
  const check = (tile) => {
    require(plugin.calculateTileViewError(tile, target) && target.error > 1e6, "an error that each limit is below");
    require(target.inView === has_visible(tile), "a tile above visible ones");
    masked += Number(!target.inView);
    tile.children?.forEach(check);
  };
  check(tiles.root);
  require(masked > 0, "nothing is masked");
  require(errors.length === 0, `${errors}`);

  // The queue begins with its last tile: what every cell needs, then weight / bytes, with what is ahead before it.
  const order = tiles.leaves
    .slice()
    .sort(tiles.downloadQueue.priorityCallback)
    .map(({ extras }) => extras.sightcell.page)
    .reverse();
  const { pages, shares } = site.cells[2];
  const weight = (page) =>
    pages.includes(page) ? 2 ** (-shares[pages.indexOf(page)] / 8) / site.pages[page].bytes : 0;
  const camera = tiles.cameras[0];
  const frustum = new THREE.Frustum().setFromProjectionMatrix(
    new THREE.Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse),
  );
  const is_ahead = (page) => {
    const [a, b, c, d, e, f] = site.pages[page].box;
    return frustum.intersectsBox(new THREE.Box3(new THREE.Vector3(a, b, c), new THREE.Vector3(d, e, f)));
  };
  const priority = (page) => (page === 0 ? Infinity : weight(page) * (is_ahead(page) ? 16 : 1));
  const expected = tiles.leaves
    .map(({ extras }) => extras.sightcell.page)
    .reverse()
    .sort((a, b) => priority(b) - priority(a) || 0);
  same(order, expected, "the order of the queue");
  const of_others = [
    { place: 1, extras: {} },
    { place: 0, internal: { renderer: {} }, extras: { sightcell: { page: 1 } } },
  ];
  require(tiles.downloadQueue.priorityCallback(...of_others) === 1, "tiles of others");
  tiles.go(new THREE.Vector3(-50, 0, 0));
  require(plugin.cell === 2, "outside, the last cell is kept");
  const updates = { ...tiles };
  plugin.dispose();
  tiles.go(rooms[0]);
  require(plugin.cell === 2 && updates.updates === tiles.updates, "after dispose");
  require(tiles.downloadQueue.priorityCallback === before, "the queue has its order again");
}

// A page that no draw shows has no tile. It is never there.
async function pages_without_tiles() {
  new FakeServer(join(sites, "rooms.site"));
  const tiles = new FakeRenderer(),
    plugin = new CellTilesPlugin(base);
  const [missing, ...others] = site.cells[0].pages;
  const remove = ({ children }) => {
    const place = children?.findIndex(({ extras }) => extras?.sightcell.page === missing) ?? -1;
    if (place >= 0) children.splice(place, 1);
    children?.forEach(remove);
  };
  remove(tiles.root);
  plugin.init(tiles);
  await until(() => tiles.updates > 0, "the front");
  tiles.go(rooms[0]);
  await until(() => plugin.cell === 0, "the chunk");
  for (const page of [0, ...others]) tiles.dispatchEvent({ type: "load-model", tile: tiles.page(page) });
  require(plugin.complete, "a page without a tile");
  plugin.dispose();
}

// A server that is away for a while, and one that lies once.
async function chunks_are_requested_again() {
  for (const [fault, id] of [
    ["network", "io"],
    [(bytes) => bytes.subarray(1), undefined],
  ]) {
    const server = new FakeServer(join(sites, "rooms.site"));
    server.faults.set(site.chunks[0].url, (time) => (time === 1 ? fault : undefined));
    const tiles = new FakeRenderer(),
      errors = [];
    const plugin = new CellTilesPlugin(base, { onError: (error) => errors.push(error.id) });
    plugin.init(tiles);
    await until(() => tiles.updates > 0, "the front");
    tiles.go(rooms[0]);
    await until(() => errors.length > 0 || plugin.cell === 0, "an answer");
    require(plugin.visible(tiles.leaves[0]) || id === undefined, "without cells, all is visible");
    tiles.go(rooms[1]);
    await until(() => plugin.cell === 1, "the second answer");
    same(errors, id === undefined ? [] : [id], "errors");
    require(tiles.leaves.some((tile) => !plugin.visible(tile)), "nothing is masked");
    plugin.dispose();
  }
}

// Without cells, tiles are loaded by distance.
async function failures_leave_the_distance() {
  for (const name of ["scene.front", site.chunks[0].url]) {
    const server = new FakeServer(join(sites, "rooms.site"));
    server.faults.set(name, () => 404);
    const tiles = new FakeRenderer(),
      errors = [];
    const plugin = new CellTilesPlugin(base, { onError: (error) => errors.push(error) });
    plugin.init(tiles);
    await until(() => tiles.updates > 0, "the front");
    tiles.go(rooms[0]);
    await until(() => errors.length > 0, "an error");
    await pause();
    tiles.go(rooms[1]);
    require(errors.map(({ id }) => id).join() === "absent", `${name}: ${errors}`);
    const target = { inView: true, error: 0 };
    require(!plugin.calculateTileViewError(tiles.root, target) &&
      target.inView &&
      target.error === 0, "the tile is changed");
    require(tiles.leaves.every((tile) => plugin.visible(tile)), "a tile is not visible");
    plugin.dispose();
  }
}

function declarations_are_members() {
  const text = readFileSync(join(folder, "tiles.d.ts"), "utf8");
  const [, body] = text.match(/^export class CellTilesPlugin \{\n(.*?)^\}/ms);
  const declared = Array.from(body.matchAll(/^ {2}(?:readonly )?(\w+)[(:]/gm), ([, member]) => member).sort();
  const members = Object.getOwnPropertyNames(CellTilesPlugin.prototype).concat("name").sort();
  same(declared, members, "tiles.d.ts");
}

declarations_are_members();
await cells_choose_the_tiles();
await pages_without_tiles();
await chunks_are_requested_again();
await failures_leave_the_distance();
console.log("tiles of three rooms");
