// What the tests of the client have in common: the three rooms, cameras in them, and what is drawn of them.
import { readFileSync } from "node:fs";
import { join } from "node:path";

import { require } from "../host.mjs";
import { drawn_of, polygons_of, read_glb } from "../npm/town.mjs";
import { base, clock, FakeServer, project_of, until } from "./fake_web.mjs";

export const [folder, sites, three] = process.argv.slice(2);
export const { load, project } = project_of(folder, three);
export const THREE = await load("three/build/three.module.js");
export const { stream, StreamError } = await load("sightcell-stream/stream.js");
export const site = JSON.parse(readFileSync(join(sites, "rooms.json"), "utf8"));
const polygons = polygons_of(THREE, read_glb(join(sites, "rooms.glb")));
for (const level of ["warn", "error", "log"]) {
  const print = console[level];
  console[level] = (text) => {
    if (level === "log") print(text);
    else throw new Error(`console.${level}: ${text}`);
  };
}

export const rooms = [0, 1, 2].map((i) => new THREE.Vector3(9 * i + 6, 2, 6));
export const inner = new THREE.Vector3(4, 2, 4);  // in cell 3, which is in cell 0
export const pages_of = (cell) => [0, ...site.cells[cell].pages].map((page) => site.pages[page].url);
export const [[small, large], [leaves]] = site.images.map((files) => files.map(({ url }) => url));
const names_of = (draw) => `${draw.node} ${draw.primitive} ${draw.instance}`;

export function camera_at(eye, look = [eye.x, eye.y, eye.z - 1]) {
  const camera = new THREE.PerspectiveCamera(60, 16 / 9, 0.05, 1000);
  camera.position.copy(eye);
  camera.lookAt(...look);
  return camera;
}

// Has everything in its frustum, from wherever.
export function camera_of_all() {
  const camera = new THREE.OrthographicCamera(-500, 500, 500, -500, -500, 500);
  camera.updateMatrixWorld(true);
  return camera;
}

export async function opened(eye, options = {}, server = new FakeServer(join(sites, "rooms.site"))) {
  const scene = new THREE.Scene(),
    camera = camera_at(eye),
    errors = [];
  let returned = false;
  const onChange = () => require(returned, "onChange before stream() has returned");
  const made = await stream(base, scene, camera, {
    onError: (error) => errors.push(error),
    onChange,
    lookahead: 0,
    ...options,
  });
  returned = true;
  const go = async (to) => {
    camera.position.copy(to);
    clock.skipped += 1000;
    made.update(camera);
    await until(() => made.complete, `the cell at ${to.toArray()}`);
  };
  return { scene, camera, made, errors, server, go };
}

export const corners_of = (text) => text.split("; ").map((corner) => corner.split(" ").map(Number));
function are_near(a, b) {
  const [p, q] = [corners_of(a), corners_of(b)];
  return [0, 1, 2].some((turn) =>
    p.every((corner, i) => corner.every((end, k) => Math.abs(end - q[(i + turn) % 3][k]) < 2e-3)),
  );
}

// Each drawn polygon is one of the scene, and no other than the expected ones. all: each of these is drawn.
export function check_drawn(scene, draws, all, what) {
  const names = new Set(draws.map((number) => names_of(site.draws[number])));
  const expected = polygons.filter(({ draw }) => names.has(draw)).map(({ text }) => text);
  const { polygons: drawn, calls } = drawn_of(THREE, scene, camera_of_all());
  const left = new Set(expected);
  scene.traverse((mesh) => {
    const matrix = new THREE.Matrix4();
    for (let i = 0; mesh.isBatchedMesh && i < (mesh.instanceCount ?? mesh._drawInfo.length); ++i) {
      mesh.getMatrixAt(i, matrix);
      require(matrix.determinant() > 0 && !mesh.material.transparent, `${what}: mirrored or transparent in a batch`);
    }
  });
  for (const polygon of drawn) {
    const match = left.has(polygon) ? polygon : Array.from(left).find((each) => are_near(each, polygon));
    require(match !== undefined, `${what}: ${polygon} is drawn, and should not be`);
    left.delete(match);
  }
  require(!all || left.size === 0, `${what}: ${left.size} of ${expected.length} polygons are not drawn`);
  return { calls, count: drawn.length };
}

const always = site.draws.map((_, number) => number).filter((number) => site.draws[number].flags & 2);
export const draws_of = (...cells) => [...new Set([...always, ...cells.flatMap((cell) => site.cells[cell].draws)])];
