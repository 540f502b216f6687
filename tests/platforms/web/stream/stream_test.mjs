// The client in node with three.js: what is drawn, in which order files are requested, memory, dispose.
// usage: stream_test.mjs PACKAGE_FOLDER SITE_FOLDER THREE_FOLDER
import { copyFileSync, readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";

import { require } from "../host.mjs";
import { drawn_of } from "../npm/town.mjs";
import { base, bitmaps, clock, FakeServer, pause, until } from "./fake_web.mjs";
import {
  camera_at,
  camera_of_all,
  check_drawn,
  corners_of,
  draws_of,
  folder,
  inner,
  large,
  leaves,
  load,
  opened,
  pages_of,
  project,
  rooms,
  site,
  sites,
  small,
  THREE,
} from "./rooms.mjs";

const { CameraView } = await load("sightcell-stream/camera_view.js");
const { Cells } = await load("sightcell-stream/cells.js");

async function each_room_is_drawn() {
  const { scene, made, errors, go } = await opened(rooms[0]);
  const found = [];
  require(scene.children.length === 1 && scene.children[0] === made.group, "the group is in the scene");
  for (const [number, eye] of rooms.entries()) {
    await go(eye);
    require(made.cell === number && !made.outside && made.progress === 1, `cell ${made.cell}`);
    const { weight } = made,
      { pages, shares, weight: whole } = site.cells[number];
    const sum = pages.reduce((total, _, i) => total + whole * 2 ** (-shares[i] / 8), 0);
    require(Math.abs(weight - sum) < 1e-3, `weight ${weight} instead of ${sum}`);
    found.push(check_drawn(scene, draws_of(number), false, `room ${number}`));
  }
  // Now all pages are there, and a draw has all of its polygons. A group that was moved moves the cells with it.
  made.group.position.set(100, 0, 0);
  for (const [number, eye] of [rooms[0], rooms[1], rooms[2], inner].entries()) {
    await go(eye.clone().add(made.group.position));
    require(made.cell === number, `cell ${made.cell} instead of ${number}`);
    made.group.position.set(0, 0, 0);
    check_drawn(scene, draws_of(number), true, `room ${number} with all pages`);
    made.group.position.set(100, 0, 0);
  }
  await go(new THREE.Vector3(-50, 0, 0));
  require(made.cell === 3 && made.outside, "outside, the last cell is kept");
  require(errors.length === 0, `${errors}`);
  made.dispose();
  return found;
}

// With one request at a time: the front, the chunk, what all cells need, then weight / bytes, then larger images.
async function requests_are_in_order() {
  const { made, server, camera } = await opened(rooms[0], { requests: 1 });
  await until(() => made.complete && server.names().includes(large), "the larger image");
  const { pages, shares, images, imageShares } = site.cells[0];
  // All pages are in all headings. The test of what is ahead is the next one.
  require(site.cells[0].headings.every((bits) => bits === 255), "headings");
  const view = new CameraView(0);
  view.move(camera, made.group, 0);
  view.look();
  const ahead = view.sectors.reduce((sum, share) => sum + share / 8, 0);
  require(ahead > 0.2 && ahead < 0.5, `${ahead} of all headings`);
  const files = [
    ...pages.map((page, i) => [site.pages[page], shares[i], ahead]),
    ...images.map((image, i) => [site.images[image][0], imageShares[i], 1]),
  ];
  const priority = ([{ bytes }, share, part]) => (part * 2 ** (-share / 8)) / bytes;
  const expected = [
    "scene.front",
    site.chunks[0].url,
    pages_of(0)[0],
    ...files.sort((a, b) => priority(b) - priority(a)).map(([{ url }]) => url),
    large,
  ];
  require(server.names().join() === expected.join(), `requested: ${server.names()}\nexpected: ${expected}`);
  require(server.most_active === 1, `${server.most_active} requests at a time`);
  require(server.log.every(
    ({ name, init }) => name === "scene.front" || init.priority === (name === large ? "low" : "high"),
  ), "priorities");
  require(server.log[0].init.cache === "no-cache" &&
    server.log.slice(1).every(({ init }) => init.cache === undefined), "caches");
  made.dispose();
}

// The policy itself, with a view that sees one page and with one that has another heading.
async function files_ahead_come_first() {
  const file = (number, more) => ({ number, bytes: 1000, state: 0, wanted: 0, needed: 0, ...more });
  const pages = [0, 1, 2, 3].map((number) => file(number, { box: [number, 0, 0, number + 1, 1, 1] }));
  const cell = {
    number: 7,
    box: [0, 0, 0, 4, 4, 4],
    weight: 1,
    pages: [0, 1, 2, 3],
    shares: [0, 8, 47, 49],
    headings: [1, 1, 5, 2],
    runs: [],
    images: [],
    imageShares: [],
  };
  const chunks = [
    file(0, { box: [0, 0, 0, 4, 4, 4], cells: [cell], state: 2 }),
    file(1, { box: [6, 0, 0, 9, 4, 4], cells: null }),
    file(2, { box: [30, 0, 0, 33, 4, 4], cells: null }),
  ];
  const cells = new Cells({
    pages,
    images: [],
    chunks,
    files: [...chunks, ...pages],
    everywhere: { pages: [], images: [] },
  });
  const eye = { x: 1, y: 1, z: 1 };
  require(cells.move(eye) && cells.cell === cell && !cells.move(eye), "the cell");
  const order = (view) => {
    const at_rest = { eye, velocity: { x: 0, y: 0, z: 0 }, seconds: 0, sectors: Array(8).fill(1), sees: () => true };
    return cells
      .requests({ ...at_rest, ...view })
      .list.map((each) => (chunks.includes(each) ? `chunk ${each.number}` : each.number))
      .join();
  };
  require(order({}) === "0,1,2,3", order({}));
  // 2^(-47/8) is 1/58.7, 2^(-49/8) is 1/69.8, and a page that the view does not show counts 1/64.
  require(order({ sees: (box) => box[0] === 2 }) === "2,0,1,3", order({ sees: (box) => box[0] === 2 }));
  require(order({ sees: (box) => box[0] === 3 }) === "0,3,1,2", order({ sees: (box) => box[0] === 3 }));
  const sectors = (...some) => ({ sectors: Array.from({ length: 8 }, (_, k) => some[k] ?? 0) });
  require(order(sectors(0, 1)) === "0,3,1,2", order(sectors(0, 1)));
  // Page 2 is in sectors 0 and 2, so half of it counts.
  require(order(sectors(0, 0.25, 1)) === "0,2,1,3", order(sectors(0, 0.25, 1)));
  require(order({ seconds: 2 }) === "0,1,2,3", "a camera at rest reaches 1.5 m, and the chunk is 5 m away");
  require(order({ seconds: 2, velocity: { x: 3, y: 0, z: 0 } }) === "0,1,2,3,chunk 1", "the chunk in the way");
  require(order({ seconds: 2, velocity: { x: -3, y: 0, z: 0 } }) === "0,1,2,3", "the way back");
  // Boxes are 1 m wide, from x = 0 on. A page that was given up is not to come.
  const clear = [];
  for (const [number, state] of [[1, 2], [0, 2], [2, 3], [3, 2]]) {
    clear.push(cells.clearDistance({ x: -1, y: 0.5, z: 5 }));
    pages[number].state = state;
  }
  clear.push(cells.clearDistance(eye));
  const expected = [Math.hypot(1, 4), Math.hypot(1, 4), Math.hypot(3, 4), Math.hypot(4, 4), Infinity];
  require(clear.join() === expected.join(), `clear up to ${clear}`);
  pages.forEach((page) => {
    page.state = 2;
  });
  require(cells.count().missing === 0 && cells.complete === cell, "complete");
  require(cells.removable().length === 0, "files of the cell are not removable");
}

// What a camera sees, against points of its picture.
function a_camera_sees_its_picture() {
  const group = new THREE.Group();
  group.position.set(5, -3, 2);
  group.rotation.y = 0.7;
  const camera = new THREE.PerspectiveCamera(50, 1.6, 0.1, 100);
  camera.rotation.order = "YXZ";
  const point = new THREE.Vector3(),
    box = (p) => [p.x - 0.1, p.y - 0.1, p.z - 0.1, p.x + 0.1, p.y + 0.1, p.z + 0.1];
  let all = 0,
    needless = 0,
    lacking = 0;
  for (let i = 0; i < 300; ++i) {
    const view = new CameraView(0);
    camera.position.set(Math.sin(i), Math.sin(2 * i), Math.sin(3 * i)).multiplyScalar(20);
    camera.rotation.set(1.5 * Math.sin(5 * i), 3 * Math.sin(7 * i), 0);
    require(view.move(camera, group, i) && !view.move(camera, group, i + 1), "moved once");
    view.look();
    const headings = new Set();  // parts of sectors
    for (let x = -1; x <= 1; x += 0.04) {
      for (let y = -1; y <= 1; y += 0.04) {
        group.worldToLocal(point.set(x, y, 0.5).unproject(camera));
        const angle = Math.atan2(point.z - view.eye.z, point.x - view.eye.x);
        headings.add((Math.floor((angle / Math.PI) * 32) + 64) % 64);
        require(view.sees(box(point)), `camera ${i} does not see ${x} ${y}`);
      }
    }
    const seen = Array(8).fill(0);
    for (const part of headings) seen[part >> 3] += 1 / 8;
    const beyond = view.sectors.map((share, k) => share - seen[k]);
    require(beyond.every((share) => share >= -1 / 8), `camera ${i}: headings ${view.sectors} of ${seen}`);
    lacking -= beyond.reduce((total, share) => total + Math.min(share, 0), 0);
    needless += beyond.reduce((total, share) => total + Math.max(share, 0), 0);
    all += Number(view.sectors.every((share) => share === 1));
    const eyes = new THREE.ArrayCamera([camera, camera]),
      both = new CameraView(0);
    both.move(eyes, group, i);
    both.look();
    require(both.sectors.join() === view.sectors.join() && both.eye.equals(view.eye), "both eyes of a headset");
    require(!view.sees(box(group.worldToLocal(camera.localToWorld(point.set(0, 0, 1))))), "what is behind it");
    require(!view.sees(box(group.worldToLocal(camera.localToWorld(point.set(2, 0, -1))))), "what is beside it");
  }
  const counts = `${all} cameras see all headings, ${needless} are needless, ${lacking} are lacking`;
  require(all > 20 && all < 200 && needless < 100 && lacking < 50, counts);
  // Between the middles of two parts.
  const narrow = new CameraView(0);
  camera.rotation.set(0, 0, 0);
  group.rotation.y = -Math.PI / 64;
  camera.zoom = 1000;
  camera.updateProjectionMatrix();
  narrow.move(camera, group, 0);
  narrow.look();
  require(narrow.sectors.filter((share) => share > 0).join() === "0.125", `a narrow view: ${narrow.sectors}`);
  const flat = new CameraView(0);
  flat.move(camera_of_all(), group, 0);
  flat.look();
  require(flat.sectors.every((share) => share === 1), "a camera without perspective");
  camera.zoom = 1;
  camera.updateProjectionMatrix();
  const view = new CameraView(0);
  for (let i = 0; i < 100; ++i) {
    camera.position.set(0.05 * i, 0, 0);
    view.move(camera, group, 1000 + 16 * i);
  }
  require(Math.abs(view.velocity.length() - 0.05 / 0.016) < 0.1, `a velocity of ${view.velocity.length()} m/s`);
  camera.position.set(50, 0, 0);
  view.move(camera, group, 1000 + 1600);
  require(view.velocity.length() === 0, "a jump");
}

// While a new cell waits for its pages, the old one is drawn, too. What is no longer needed is canceled.
async function the_last_complete_cell_stays() {
  const server = new FakeServer(join(sites, "rooms.site"));
  const { scene, camera, made, go } = await opened(rooms[0], { requests: 1 }, server);
  await go(rooms[0]);
  await until(() => server.active === 0, "the larger image");
  const { polygons: before } = drawn_of(THREE, scene, camera_of_all());
  server.holds = (name) => name.startsWith("pages/");
  camera.position.copy(rooms[1]);
  clock.skipped += 1000;
  made.update(camera);
  await until(() => server.held().length === 1, "a request");
  require(made.cell === 1 && !made.complete && made.progress < 1, `cell ${made.cell}`);
  check_drawn(scene, draws_of(0, 1), false, "two rooms");
  require(made.clearDistance < 20, `clear up to ${made.clearDistance}`);
  const canceled = server.held();
  camera.position.copy(rooms[2]);
  clock.skipped += 1000;
  made.update(camera);
  await until(() => server.held().length === 1 && !canceled.includes(server.held()[0]), "another request");
  require(server.most_active === 1, `${server.most_active} requests at a time`);
  require(server.held().every((name) => pages_of(2).includes(name)), `${server.held()}`);
  const { polygons: then } = drawn_of(THREE, scene, camera_of_all());
  require(before.length > 0 && before.every((polygon) => then.includes(polygon)), "a polygon has vanished");
  server.holds = () => false;
  server.release();
  await until(() => made.complete, "the third room");
  require(made.clearDistance === Infinity, "all is there");
  check_drawn(scene, draws_of(2), false, "only the third room");
  await go(rooms[1]);
  require(canceled.every((name) => server.names().filter((each) => each === name).length === 2), "requested again");
  made.dispose();
}

async function nothing_is_done_at_rest() {
  const { camera, made, server, go } = await opened(rooms[0], { lookahead: 2 });
  await go(rooms[0]);
  await until(() => server.active === 0 && server.names().includes(large), "the larger image");
  clock.skipped += 1000;
  made.update(camera);
  await pause();
  const counts = { move: 0, count: 0, requests: 0 },
    original = {};
  for (const name of Object.keys(counts)) {
    original[name] = Cells.prototype[name];
    Cells.prototype[name] = function (...args) {
      ++counts[name];
      return original[name].apply(this, args);
    };
  }
  const requests = server.log.length;
  for (let i = 0; i < 100; ++i) {
    clock.skipped += 20;
    made.update(camera);
  }
  require(Object.values(counts).join() === "0,0,0", `at rest: ${JSON.stringify(counts)}`);
  for (let i = 0; i < 100; ++i) {
    clock.skipped += 20;
    camera.rotation.y += 0.01;
    made.update(camera);
  }
  const { requests: lists } = counts;
  require(counts.count === 0 &&
    counts.move === 100 &&
    lists <= 21 &&
    lists >= 10, `turning: ${JSON.stringify(counts)}`);
  require(server.log.length === requests, "requests");
  Object.assign(Cells.prototype, original);
  made.dispose();
}

async function memory_is_limited() {
  const { made, server, go, scene } = await opened(rooms[0], { memory: 20000 });
  const sizes = [];
  for (let round = 0; round < 3; ++round) {
    for (const [number, eye] of rooms.entries()) {
      await go(eye);
      await until(() => server.active === 0, "all requests");
      await pause(5);
      sizes.push(made.memoryBytes);
      check_drawn(scene, draws_of(number), false, `room ${number} in round ${round}`);
      require(made.memoryBytes <= 20000 || number !== 1, `${made.memoryBytes} bytes in a room without images`);
    }
  }
  require(sizes.slice(3, 6).join() === sizes.slice(6).join(), `it grows: ${sizes}`);
  const again = pages_of(1).filter((name) => server.names().filter((each) => each === name).length > 1);
  require(again.length > 0, "no page was removed");
  require(server.names().filter((each) => each === pages_of(1)[0]).length === 1, "what all cells need stays");
  require(server.names().filter((each) => each === large).length === 0, "a larger image has no place");
  made.dispose();
  require(bitmaps.open === 0, `${bitmaps.open} images are open`);
}

// Polygons wait for the first version of their images; one that cannot be shown is left out.
async function images_arrive_and_grow() {
  const server = new FakeServer(join(sites, "rooms.site"));
  server.holds = (name) => name.startsWith("images/");
  const { scene, made, errors } = await opened(rooms[0], {}, server);
  const materials = () => {
    const found = new Map();
    scene.traverseVisible(({ material }) => material && found.set(material.name, material));
    return found;
  };
  const other_pages = () => materials().has("stone") && materials().has("wood");
  await until(() => made.progress === 1 && server.held().length === 2 && other_pages(), "all but the images");
  require(!made.complete, "complete without images");
  require([...materials().keys()].sort().join() === "stone,wood", `without images: ${[...materials().keys()]}`);
  server.release((name) => name === leaves);
  await until(() => materials().has("leaves"), "leaves");
  server.holds = (name) => name === large;
  server.release();
  await until(() => made.complete && server.held().length === 1, "bricks");
  const { map, alphaTest } = materials().get("bricks");
  require(map.image.width === 64 &&
    map.wrapS === THREE.RepeatWrapping &&
    map.colorSpace === THREE.SRGBColorSpace &&
    !map.flipY, "the texture");
  const leaf = materials().get("leaves");
  require(leaf.alphaTest === 0.5 &&
    leaf.side === THREE.DoubleSide &&
    leaf.map.wrapS === THREE.ClampToEdgeWrapping &&
    alphaTest === 0, "leaves");
  const { version } = map;
  let disposed = 0;  // for other storage on the device
  map.addEventListener("dispose", () => ++disposed);
  server.release();
  await until(() => map.image.width === 72, "the larger image");
  require(map.version > version && disposed === 1 && bitmaps.open === 2, `${bitmaps.open} images are open`);
  require(errors.length === 0, `${errors}`);
  made.dispose();
  require(bitmaps.open === 0, `${bitmaps.open} images are open after dispose`);

  const broken = new FakeServer(join(sites, "rooms.site"));
  broken.faults.set(small, () => 404).set(large, () => 404);
  const without = await opened(rooms[0], {}, broken);
  await without.go(rooms[0]);
  require(without.errors.map(({ id, url }) => `${id} ${url}`).join() ===
    `absent ${base}${small},absent ${base}${large}`, `${without.errors}`);
  without.scene.traverseVisible(({ material }) =>
    require(material?.name !== "bricks" || material.map === null, "a map"),
  );
  check_drawn(without.scene, draws_of(0), false, "without an image");
  without.made.dispose();
}

async function any_order_of_answers() {
  const seen = [];
  for (const backward of [false, true]) {
    const server = new FakeServer(join(sites, "rooms.site"));
    server.holds = (name) => /pages|images/.test(name);
    const { scene, made } = await opened(rooms[0], { requests: 3 }, server);
    while (!made.complete) {
      await until(() => server.held().length > 0 || made.complete, "a request");
      const names = server.held();
      const chosen = names[backward ? names.length - 1 : 0];
      server.release((name) => name === chosen);
      await pause(5);
    }
    seen.push(drawn_of(THREE, scene, camera_of_all()).polygons.join("\n"));
    server.release();
    made.dispose();
  }
  require(seen[0] === seen[1] && seen[0].length > 1000, "the order of answers changes what is drawn");
}

async function what_the_host_moves() {
  const { made, scene, go } = await opened(rooms[0]);
  await go(rooms[0]);
  const crate = made.draws.findIndex(({ flags }) => flags & 1);
  require(crate >= 0 && made.draws[crate].node === 10, `draw ${crate}`);
  const before = made.draws[crate].matrix.clone();
  made.moveDraw(crate, before.clone().premultiply(new THREE.Matrix4().makeTranslation(0, 300, 0)));
  const { polygons: drawn } = drawn_of(THREE, scene, camera_of_all());
  const moved = drawn.filter((text) => corners_of(text).every(([, y]) => y > 299));
  require(moved.length === 12, `${moved.length} polygons have moved`);
  made.dispose();
}

async function dispose_ends_all() {
  for (const stage of ["pages", "images", "cells"]) {
    const server = new FakeServer(join(sites, "rooms.site"));
    server.holds = (name) => name.startsWith(stage);
    const { scene, made, camera, errors } = await opened(rooms[0], {}, server);
    await until(() => server.held().length > 0, stage);
    await pause();
    made.dispose();
    made.dispose();
    server.release();
    await pause();
    require(scene.children.length === 0 &&
      made.group.children.length === 0 &&
      server.active === 0, `${stage}: something is left`);
    require(bitmaps.open === 0 &&
      made.memoryBytes === 0 &&
      errors.length === 0, `${stage}: ${bitmaps.open} images, ${errors}`);
    let id;
    try {
      made.update(camera);
    } catch (error) {
      ({ id } = error);
    }
    require(id === "disposed", `update() after dispose(): ${id}`);
  }
}

// The README.md shows what runs, and the declarations have the members that there are.
async function the_documents_are_right() {
  const name = join(dirname(fileURLToPath(import.meta.url)), "show.mjs");
  const shown = readFileSync(name, "utf8").match(/\/\* \[stream \*\/\n(.*?)\/\* stream\] \*\//s)[1];
  require(readFileSync(join(folder, "README.md"), "utf8").includes(`\`\`\`js\n${shown}\`\`\``), "README.md");
  copyFileSync(name, join(project, "show.mjs"));
  const { showSite } = await import(pathToFileURL(join(project, "show.mjs")).href);
  new FakeServer(join(sites, "rooms.site"));
  const scene = new THREE.Scene(),
    calls = [];
  let draw;
  const renderer = { setAnimationLoop: (act) => (draw = act), render: (...args) => calls.push(args) };
  const made = await showSite(base, renderer, scene, camera_at(rooms[0]));
  draw();
  require(calls.length === 1 && calls[0][0] === scene, "nothing was rendered");
  await until(() => made.complete, "the page of the README.md");
  const [, body] = readFileSync(join(folder, "stream.d.ts"), "utf8").match(/^export interface Stream \{\n(.*?)^\}/ms);
  const declared = Array.from(body.matchAll(/^ {2}(?:readonly )?(\w+)[(:]/gm), ([, member]) => member);
  const inherited = Object.getOwnPropertyNames(Object.getPrototypeOf(made));
  const members = [...Object.keys(made), ...inherited.filter((member) => member !== "constructor")];
  require(declared.sort().join() === members.sort().join(), `declared ${declared}, found ${members}`);
  made.dispose();
}

const found = await each_room_is_drawn();
await requests_are_in_order();
await files_ahead_come_first();
a_camera_sees_its_picture();
await the_last_complete_cell_stays();
await nothing_is_done_at_rest();
await memory_is_limited();
await images_arrive_and_grow();
await any_order_of_answers();
await what_the_host_moves();
await dispose_ends_all();
await the_documents_are_right();
console.log(
  `three.js ${THREE.REVISION}: ${found.map(({ calls, count }) => `${count} polygons in ${calls} calls`).join(", ")}`,
);
