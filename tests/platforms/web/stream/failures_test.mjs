// The client in node with three.js, over a server that fails, lies and has damaged files.
// usage: failures_test.mjs PACKAGE_FOLDER SITE_FOLDER THREE_FOLDER
import { createHash } from "node:crypto";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { deflateSync, inflateSync } from "node:zlib";

import { require } from "../host.mjs";
import { base, clock, FakeServer, pause, until } from "./fake_web.mjs";
import {
  camera_at,
  check_drawn,
  draws_of,
  leaves,
  opened,
  pages_of,
  rooms,
  site,
  sites,
  stream,
  StreamError,
  THREE,
} from "./rooms.mjs";

async function lies_are_refetched_once() {
  const [page] = pages_of(0).slice(1);
  const flip = (bytes) => {
    bytes[bytes.length >> 1] ^= 1;
    return bytes;
  };
  const cut = (bytes) => bytes.subarray(0, -1);
  for (const [change, id] of [
    [flip, "checksum"],
    [cut, "truncated"],
  ]) {
    for (const name of [page, site.chunks[0].url, leaves]) {
      const server = new FakeServer(join(sites, "rooms.site"));
      server.faults.set(name, (time) => (time === 1 ? change : undefined));
      const { made, errors } = await opened(rooms[0], {}, server);
      await until(() => made.complete, "after a refetch");
      const caches = server.log.filter((each) => each.name === name).map(({ init }) => init.cache);
      require(errors.length === 0 &&
        made.progress === 1 &&
        caches.join() === ",reload", `${name}: ${errors}, ${caches}`);
      made.dispose();
    }
    const server = new FakeServer(join(sites, "rooms.site"));
    server.faults.set(page, () => change);
    const { scene, made, errors } = await opened(rooms[0], {}, server);
    await until(() => made.complete, "without the page");
    await pause();
    require(errors.length === 1 &&
      errors[0] instanceof StreamError &&
      errors[0].id === id &&
      errors[0].url === base + page, `${errors}`);
    require(errors[0].message.startsWith(`sightcell: ${base}${page}: `), errors[0].message);
    require(made.failed === 1 && made.progress < 1 && made.progress > 0, `progress ${made.progress}`);
    require(server.names().filter((each) => each === page).length === 2, "two requests");
    check_drawn(scene, draws_of(0), false, "without a page");
    made.dispose();
  }
}

async function what_is_missing_is_reported() {
  const [page] = pages_of(0).slice(1);
  const server = new FakeServer(join(sites, "rooms.site"));
  server.faults.set(page, () => 404);
  const { made, errors, go, scene } = await opened(rooms[0], {}, server);
  await go(rooms[0]);
  require(errors.map(({ id }) => id).join() === "absent" && made.failed === 1, `${errors}`);
  await go(rooms[2]);
  await go(rooms[0]);
  require(errors.length === 1 &&
    server.names().filter((name) => name === page).length === 1, "it is not requested again");
  check_drawn(scene, draws_of(0), false, "without a page");
  made.dispose();
  for (const [status, id] of [
    [404, "absent"],
    [500, "io"],
    ["network", "io"],
  ]) {
    const broken = new FakeServer(join(sites, "rooms.site"));
    broken.faults.set("scene.front", () => status);
    const error = await opened(rooms[0], {}, broken).then(
      () => undefined,
      (thrown) => thrown,
    );
    require(error instanceof StreamError && error.id === id, `${status}: ${error}`);
  }
}

// A server that is away for a while: the cell becomes complete, and an error is reported after four attempts.
async function the_network_comes_back() {
  const [page] = pages_of(0).slice(1);
  clock.hurry = 100;
  for (const times of [3, 6]) {
    const server = new FakeServer(join(sites, "rooms.site"));
    server.faults.set(page, (time) => (time <= times ? (time % 2 ? "network" : 503) : undefined));
    const { made, errors } = await opened(rooms[0], {}, server);
    await until(() => made.complete, "the network");
    require(made.progress === 1 && made.failed === 0, "all is there");
    require(errors.length === Number(times > 3) && errors.every(({ id }) => id === "io"), `${times}: ${errors}`);
    require(server.names().filter((name) => name === page).length === times + 1, "attempts");
    made.dispose();
  }
  // A transfer that never ends is given up and begun again.
  const server = new FakeServer(join(sites, "rooms.site"));
  let times = 0;
  server.holds = (name) => name === page && ++times === 1;
  const { made, errors } = await opened(rooms[0], {}, server);
  await until(() => made.complete, "after a transfer that has stalled");
  require(times === 2 && errors.length === 0, `${times} requests, ${errors}`);
  made.dispose();
  clock.hurry = 1;
}

// A page that is damaged although its hash is right: it is reported, and the others are drawn.
async function damaged_pages_are_reported() {
  const { url, bytes } = site.pages[site.cells[0].pages[0]];
  const changes = {
    "no glTF": (page) => page.write("flTG", 0),
    "an index out of range": (page) => page.fill(0xff, page.length - 60, page.length - 20),
    "other numbers of polygons": (page) => {
      const at = page.indexOf('"sightcell":[') + 13;
      page.write(
        page.toString("latin1", at, at + 12).replace(/,([0-9])/, (_, digit) => `,${(Number(digit) + 1) % 10}`),
        at,
        "latin1",
      );
    },
  };
  for (const [what, change] of Object.entries(changes)) {
    const server = new FakeServer(join(sites, "rooms.site"));
    const page = readFileSync(join(sites, "rooms.site", url));
    change(page);
    require(page.length === bytes, "the size");
    const hash = createHash("sha256").update(page).digest("hex").slice(0, 16);
    const name = `pages/${hash}.glb`;
    server.contents.set(name, page);
    server.faults.set("scene.front", () => (front) => {
      const text = inflateSync(front.subarray(16)).toString("hex").replace(url.slice(6, 22), hash);
      return Buffer.concat([front.subarray(0, 16), deflateSync(Buffer.from(text, "hex"))]);
    });
    const { scene, made, errors } = await opened(rooms[0], {}, server);
    await until(() => made.complete, what);
    require(errors.map((error) => `${error.id} ${error.url}`).join() ===
      `corrupt ${base}${name}`, `${what}: ${errors}`);
    require(made.failed === 1, `${what}: ${made.failed} have failed`);
    check_drawn(scene, draws_of(0), false, what);
    made.dispose();
  }
}

// A front whose materials name a texture that does not exist.
async function damaged_materials_are_rejected() {
  const server = new FakeServer(join(sites, "rooms.site")),
    scene = new THREE.Scene();
  const change = (bytes) => {
    const text = inflateSync(bytes.subarray(16)).toString("latin1").replace('"index":0', '"index":9');
    return Buffer.concat([bytes.subarray(0, 16), deflateSync(Buffer.from(text, "latin1"))]);
  };
  server.faults.set("scene.front", () => change);
  const error = await stream(base, scene, camera_at(rooms[0])).then(
    () => undefined,
    (thrown) => thrown,
  );
  require(error instanceof StreamError && error.id === "corrupt", `${error}`);
  require(scene.children.length === 0, "something is left");
  await until(() => server.active === 0, "requests");
}

await lies_are_refetched_once();
await what_is_missing_is_reported();
await the_network_comes_back();
await damaged_pages_are_reported();
await damaged_materials_are_rejected();
console.log(`three.js ${THREE.REVISION}`);
