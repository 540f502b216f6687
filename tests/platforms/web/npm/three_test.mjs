// What a page draws of a small town is what the native runtime answers, in both modes, by all corners of all polygons.
// usage: three_test.mjs PACKAGE_FOLDER THREE_FOLDER SCENE_FOLDER
import { copyFileSync, cpSync, mkdirSync, mkdtempSync, readFileSync, rmSync, symlinkSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";

import { require } from "../host.mjs";
import { drawn_of, polygons_of, read_glb } from "./town.mjs";

const [folder, three, town] = process.argv.slice(2);
const project = mkdtempSync(join(tmpdir(), "sightcell-test-"));
process.on("exit", () => rmSync(project, { recursive: true }));
mkdirSync(join(project, "node_modules"));
cpSync(folder, join(project, "node_modules", "sightcell"), { recursive: true });
symlinkSync(resolve(three), join(project, "node_modules", "three"));
const load = (name) => import(pathToFileURL(join(project, "node_modules", name)).href);
const THREE = await load("three/build/three.module.js");
const { GLTFLoader } = await load("three/examples/jsm/loaders/GLTFLoader.js");
const { DebugLines, Sightcell, SightcellError } = await load("sightcell/sightcell.js");
const { attach, embeddedPvs } = await load("sightcell/three.js");
const { DebugOverlay } = await load("sightcell/three_overlay.js");

for (const level of ["warn", "error"]) console[level] = (text) => { throw new Error(`console.${level}: ${text}`); };
const sightcell = await Sightcell.load();
const db = sightcell.open(readFileSync(join(town, "town.pvs")));
const glb = read_glb(join(town, "town.glb"));
const polygons = polygons_of(THREE, glb);
require(polygons.length === db.info.polygonCount, `${polygons.length} polygons`);
const all = polygons.map(({ text }) => text).sort();

async function load_scene() {
  const { buffer, byteOffset, byteLength } = glb.bytes;
  const gltf = await new GLTFLoader().parseAsync(buffer.slice(byteOffset, byteOffset + byteLength), "");
  gltf.scene.updateMatrixWorld(true);
  return gltf;
}

const same = (found, expected, what) => {
  const only = (a, b) => a.filter((text) => !b.includes(text)).slice(0, 3);
  require(found.join("\n") === expected.join("\n"), `${what}: ${found.length} polygons instead of ${expected.length}\n` +
    `too much: ${only(found, expected)}\nmissing: ${only(expected, found)}`);
};

// The answers of the native runtime: for each cell its middle and the ranges.
const cells = readFileSync(join(town, "town.txt"), "utf8").matchAll(/^cell \d+: (.*)  (.*)\nranges \d+:(.*)$/gm);
const answers = Array.from(cells, ([, min, max, ranges]) => {
  const [low, high] = [min, max].map((ends) => ends.split(" ").map(Number));
  return { eye: new THREE.Vector3(...low.map((end, axis) => 0.5 * (end + high[axis]))),
    ranges: ranges.trim().split(" ").map(Number) };
});
require(answers.length > 5, `${answers.length} cells`);

const order = db.order();
const marked = glb.json.nodes.findIndex((node) => node.extras?.sightcell?.dynamic);
const transparent = (material) => glb.json.materials[material].alphaMode === "BLEND";
const mirrored = glb.json.nodes.findIndex((node) => node.scale?.[0] === -1);

// whole: the polygons of a draw that is shown as a whole if it has a range.
function expected_of({ ranges }, whole) {
  const visible = new Set(), draws = new Set();
  for (let i = 0; i < ranges.length; i += 3) {
    const { node, primitive, instance, firstStored } = db.draws[ranges[i]];
    draws.add(`${node} ${primitive} ${instance}`);
    for (let k = 0; k < ranges[i + 2]; ++k) visible.add(order[firstStored + ranges[i + 1] + k]);
  }
  return polygons.filter((polygon, source) => Number(polygon.draw.split(" ")[0]) === marked ||
    (whole(polygon) ? draws.has(polygon.draw) : visible.has(source))).map(({ text }) => text).sort();
}

const whole_in_ranges = ({ material, draw }) => transparent(material) || Number(draw.split(" ")[0]) === mirrored;

// Has all of the town in its frustum, from wherever.
function camera_of_all() {
  const camera = new THREE.OrthographicCamera(-500, 500, 500, -500, -500, 500);
  camera.updateMatrixWorld(true);
  return camera;
}

function camera_at(eye) {
  const camera = new THREE.PerspectiveCamera(60, 16 / 9, 0.03, 1000);
  camera.position.copy(eye);
  camera.updateMatrixWorld(true);
  return camera;
}

// Each cell, in a scene that is somewhere else than it was baked.
async function draws_the_answers(mode, whole, change = (gltf) => gltf) {
  const gltf = change(await load_scene());
  const offset = new THREE.Vector3(100, 10, -50);
  gltf.scene.position.copy(offset);
  const before = gltf.scene.children.length;
  const pvs = await attach(gltf, db, { mode });
  gltf.scene.position.set(0, 0, 0);
  let calls = 0, hidden_parents = 0;
  for (const answer of answers) {
    gltf.scene.position.copy(offset);
    const frame = pvs.update(camera_at(answer.eye.clone().add(offset)));
    require(frame.changed && !frame.drawAll, "a cell");
    require(!pvs.update(camera_at(answer.eye.clone().add(offset))).changed, "nothing changed");
    gltf.scene.position.set(0, 0, 0);
    const drawn = drawn_of(THREE, gltf.scene, camera_of_all());
    same(drawn.polygons, expected_of(answer, whole), `${mode}, cell ${frame.cell}`);
    calls += drawn.calls;
    gltf.scene.traverse(({ layers, children }) => { hidden_parents += Number(layers.mask === 0 && children.length > 0); });
  }
  require(hidden_parents > 0 || mode === "objects", "no mesh with a node below it was hidden");
  require(pvs.update(camera_at(new THREE.Vector3(1e4, 1e4, 1e4))).drawAll, "outside all cells");
  same(drawn_of(THREE, gltf.scene, camera_of_all()).polygons, all, `${mode}, outside all cells`);
  pvs.update(camera_at(answers[0].eye));
  pvs.dispose();
  require(gltf.scene.children.length === before && pvs.view.disposed, "nothing is left");
  same(drawn_of(THREE, gltf.scene, camera_of_all()).polygons, all, `${mode}, after dispose`);
  return calls / answers.length;
}

// One call for each material, and shadows of all polygons.
async function packed_batches_cast_shadows() {
  const gltf = await load_scene();
  gltf.scene.traverse((object) => { object.castShadow = object.isMesh; });
  const pvs = await attach(gltf, db, { mode: "packed" });
  require(pvs.batches.length > 3 && pvs.batches.every((mesh) => !mesh.isBatchedMesh && mesh.castShadow), "batches");
  const batched = polygons.filter((polygon) => !whole_in_ranges(polygon) && Number(polygon.draw.split(" ")[0]) !== marked);
  for (const answer of answers) {
    pvs.update(camera_at(answer.eye));
    const cast = new Set(drawn_of(THREE, gltf.scene, camera_of_all(), { shadow: true }).polygons);
    require(batched.every(({ text }) => cast.has(text)), "a polygon casts no shadow");
    same(drawn_of(THREE, gltf.scene, camera_of_all()).polygons, expected_of(answer, whole_in_ranges), "after the shadows");
  }
  pvs.dispose();
}

// Gives each geometry of a loaded scene another.
function change_geometries({ scene }, change) {
  const made = new Map();
  scene.traverse((mesh) => {
    if (!mesh.isMesh) return;
    if (!made.has(mesh.geometry)) made.set(mesh.geometry, change(mesh.geometry));
    mesh.geometry = made.get(mesh.geometry);
  });
}

// Normals are in the space of the scene, and vertices that no polygon of a draw uses are not copied.
async function packed_batches_have_attributes() {
  const gltf = await load_scene();
  change_geometries(gltf, (geometry) => {
    const flat = geometry.toNonIndexed();
    flat.computeVertexNormals();
    for (const [name, { array, itemSize }] of Object.entries(flat.attributes)) {
      const longer = new Float32Array(array.length + 1000 * itemSize);
      longer.set(array);
      flat.setAttribute(name, new THREE.BufferAttribute(longer, itemSize));
    }
    return flat.setIndex(Array.from({ length: geometry.index.count }, (_, i) => i));
  });
  const pvs = await attach(gltf, db, { mode: "packed" });
  const [a, b, c, normal] = Array.from({ length: 4 }, () => new THREE.Vector3());
  for (const { geometry: { attributes, index } } of pvs.batches) {
    require(attributes.position.count === index.count / 2, `${attributes.position.count} vertices, ${index.count} indices`);
    for (let i = index.count / 2; i < index.count; i += 3) {
      [a, b, c].forEach((corner, k) => corner.fromBufferAttribute(attributes.position, index.getX(i + k)));
      const expected = b.sub(a).cross(c.sub(a)).normalize();
      normal.fromBufferAttribute(attributes.normal, index.getX(i));
      require(normal.distanceTo(expected) < 1e-3, `a normal ${normal.toArray()} in place of ${expected.toArray()}`);
    }
  }
  pvs.dispose();
}

async function batches_are_culled_and_cast_shadows() {
  const gltf = await load_scene();
  gltf.scene.traverse((object) => { object.castShadow = object.isMesh; });
  const pvs = await attach(gltf, db, { mode: "ranges" });
  require(pvs.batches.every((mesh) => !mesh.material.transparent), "a transparent batch");
  require(polygons.some(({ material }) => transparent(material)), "nothing is transparent");
  require(pvs.batches.length > 3 && pvs.batches.every((mesh) => mesh.isBatchedMesh && mesh.castShadow), "batches");
  let culled = 0;
  for (const answer of answers) {
    const camera = camera_at(answer.eye);
    pvs.update(camera);
    const expected = expected_of(answer, whole_in_ranges);
    const frustum = new THREE.Frustum().setFromProjectionMatrix(
      new THREE.Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse));
    const inside = new Set(polygons.filter(({ corners }) => corners.some((point) => frustum.containsPoint(point)))
      .map(({ text }) => text));
    const drawn = drawn_of(THREE, gltf.scene, camera).polygons;
    same(drawn.filter((text) => inside.has(text)), expected.filter((text) => inside.has(text)), "in the frustum");
    culled += expected.length - drawn.length;
    // Shadows: all polygons of batches; then again the set.
    const batched = polygons.filter((polygon) => !whole_in_ranges(polygon) && Number(polygon.draw.split(" ")[0]) !== marked);
    const cast = new Set(drawn_of(THREE, gltf.scene, camera_of_all(), { shadow: true }).polygons);
    require(batched.every(({ text }) => cast.has(text)), "a polygon casts no shadow");
    same(drawn_of(THREE, gltf.scene, camera_of_all()).polygons, expected, "after the shadows");
  }
  require(culled > 0, "nothing was culled");
  // A headset: both eyes in one view.
  const eyes = [0, 0.06].map((x) => camera_at(answers[0].eye.clone().add(new THREE.Vector3(x, 0, 0))));
  const frame = pvs.update(new THREE.ArrayCamera(eyes));
  require(!frame.drawAll && frame.cell === 0, "two eyes");
  same(drawn_of(THREE, gltf.scene, camera_of_all()).polygons, expected_of(answers[0], whole_in_ranges), "two eyes");
  pvs.dispose();
}

async function error_of(change, options, file = db) {
  const gltf = await load_scene();
  change(gltf);
  try {
    await attach(gltf, file, options);
  } catch (error) {
    require(error instanceof SightcellError, error.stack);
    return `${error.id}: ${error.message}`;
  }
  return "no error";
}

async function a_changed_scene_is_rejected() {
  const mesh_of = ({ scene }, name) => scene.getObjectByName(name);
  const changes = {
    "outer ground": (gltf) => { mesh_of(gltf, "outer_ground").geometry.setIndex([0, 1, 2]); },
    trees: (gltf) => { mesh_of(gltf, "trees").children[0].count -= 1; },
    lamp: (gltf) => { mesh_of(gltf, "lamp").removeFromParent(); },
  };
  for (const [name, change] of Object.entries(changes)) {
    const error = await error_of(change);
    require(error.startsWith("other_scene: ") && error.includes(`"${name}"`), `${name}: ${error}`);
  }
  const more = await error_of((gltf) => { mesh_of(gltf, "trees").children[0].count += 1; });
  require(more.startsWith("other_scene: ") && more.includes("that the file lacks"), more);
  const nothing = await error_of(({ scene }) => { scene.clear(); });
  require(nothing.startsWith("other_scene: ") && nothing.includes("and 6"), nothing);
  require((await error_of(() => {}, { mode: "triangles" })).startsWith("argument: "), "a mode");
  const merged = { info: { ...db.info, layout: "merged" } };
  for (const mode of ["ranges", "packed"])
    require((await error_of(() => {}, { mode }, merged)).startsWith("argument: "), `${mode} of a merged file`);
  require(await error_of(() => {}) === "no error", "the scene itself");
  // What the page adds is no part of it.
  require(await error_of(({ scene }) => { scene.add(new THREE.Mesh(new THREE.BoxGeometry())); }) === "no error", "a box");
}

async function the_near_plane_is_checked() {
  const { playerRadius } = db.info;
  require(playerRadius > 0, "the file states the player radius");
  const texts = [];
  const pvs = await attach(await load_scene(), db, { warn: (text) => texts.push(text) });
  const camera = camera_at(answers[0].eye);
  const fitting = playerRadius / Math.sqrt(1 + Math.tan(Math.PI / 6) ** 2 * (1 + (16 / 9) ** 2));
  for (const [near, count] of [[0.999 * fitting, 0], [1.01 * fitting, 1], [1.01 * fitting, 1], [0.999 * fitting, 1],
    [2 * fitting, 2]]) {
    camera.near = near;
    camera.updateProjectionMatrix();
    pvs.update(camera);
    require(texts.length === count, `${texts.length} warnings at ${near}: ${texts}`);
  }
  require(texts[1].includes(`camera.near to ${fitting.toPrecision(3)} or less`), texts[1]);
  pvs.dispose();
}

async function a_scene_is_attached_once() {
  const gltf = await load_scene();
  for (let i = 0; i < 2; ++i) {
    const pvs = await attach(gltf, db);
    const again = await attach(gltf, db).catch((error) => error);
    require(again instanceof SightcellError && again.id === "argument", `attached twice: ${again}`);
    pvs.dispose();
  }
}

async function skipped_meshes_are_left() {
  const gltf = await load_scene();
  const pvs = await attach(gltf, db, { mode: "ranges", skip: (mesh) => mesh.isInstancedMesh === true });
  pvs.update(camera_at(answers[0].eye));
  const drawn = new Set(drawn_of(THREE, gltf.scene, camera_of_all()).polygons);
  const trees = glb.json.nodes.findIndex(({ name }) => name === "trees");
  require(polygons.every(({ draw, text }) => !draw.startsWith(`${trees} `) || drawn.has(text)), "a tree is not drawn");
  pvs.dispose();
}

// An animation moves a lamp: what it moves is drawn where it is.
async function what_moves_stays_apart() {
  const gltf = await load_scene();
  const lamp = gltf.scene.getObjectByName("lamp").parent.children.findLast((object) => object.name.startsWith("lamp"));
  const node = glb.json.nodes.findLastIndex(({ name }) => name === "lamp");
  gltf.parser.json.animations = [{ channels: [{ target: { node, path: "translation" } }] }];
  const pvs = await attach(gltf, db, { mode: "ranges" });
  pvs.update(camera_at(new THREE.Vector3(1e4, 1e4, 1e4)));
  lamp.position.y += 300;
  const { polygons: drawn } = drawn_of(THREE, gltf.scene, camera_of_all());
  const moved = drawn.filter((text) => text.split("; ").every((point) => Number(point.split(" ")[1]) > 299)).length;
  const count = polygons.filter(({ draw }) => draw.startsWith(`${node} `)).length;
  require(count > 0 && moved === count && drawn.length === all.length, `${moved} of ${count} polygons have moved`);
  pvs.dispose();
}

// The overlay has the box of the cell, and a frozen set stays while the camera moves.
async function the_overlay_freezes_the_set() {
  const gltf = await load_scene();
  gltf.scene.position.set(100, 10, -50);
  const pvs = await attach(gltf, db, { mode: "ranges" });
  const before = gltf.scene.children.length;
  const overlay = new DebugOverlay(pvs, gltf.scene, { kinds: DebugLines.cell });
  const corners = () => Array.from(overlay.lines.geometry.attributes.position.array);
  const camera_of = (cell) => camera_at(answers[cell].eye.clone().add(gltf.scene.position));
  for (const cell of [0, 1]) {
    require(overlay.update(camera_of(cell)).cell === cell, "the cell");
    const { min, max } = db.cellBox(cell);
    const box = new THREE.Box3().setFromArray(corners());
    require(corners().length === 72 && box.min.equals(new THREE.Vector3(...min)) && box.max.equals(new THREE.Vector3(...max)),
      `lines of cell ${cell}: ${corners()}`);
    require(overlay.lines.geometry.attributes.color.count === 24, "colors");
  }
  overlay.frozen = true;
  for (const cell of [1, 2]) require(overlay.update(camera_of(cell)).cell === 1, "the frozen cell");
  const eye = corners().slice(72, 75).map((end, axis) => end - answers[1].eye.getComponent(axis));
  require(corners().length === 72 + 48 && Math.hypot(...eye) < 1e-3, `the frozen camera: ${corners().slice(72)}`);
  overlay.visible = false;
  gltf.scene.position.set(0, 0, 0);
  same(drawn_of(THREE, gltf.scene, camera_of_all()).polygons, expected_of(answers[1], whole_in_ranges), "a frozen set");
  overlay.frozen = false;
  require(overlay.update(camera_of(2)).cell === 2, "the cell of the camera again");
  overlay.dispose();
  require(gltf.scene.children.length === before, "the lines are gone");
  pvs.dispose();
}

// As sightcell bake --embed writes it.
async function the_file_in_the_scene_is_found() {
  require(await embeddedPvs(await load_scene()) === null, "a scene without a file");
  const file = readFileSync(join(town, "town.pvs"));
  const { json, binary } = structuredClone({ json: glb.json, binary: glb.binary });
  const view = { buffer: 0, byteOffset: binary.length, byteLength: file.length };
  const parts = [{ ...json, bufferViews: [...json.bufferViews, view], buffers: [{ byteLength: binary.length + file.length }],
    extras: { sightcell: { pvs: { bufferView: json.bufferViews.length } } } }].map((made) => Buffer.from(JSON.stringify(made)));
  const padded = Buffer.concat([parts[0], Buffer.alloc((4 - parts[0].length % 4) % 4, " ")]);
  const body = Buffer.concat([binary, file, Buffer.alloc((4 - (binary.length + file.length) % 4) % 4)]);
  const numbers = (...values) => Buffer.from(Uint32Array.from(values).buffer);
  const bytes = Buffer.concat([numbers(0x46546c67, 2, 28 + padded.length + body.length, padded.length, 0x4e4f534a), padded,
    numbers(body.length, 0x004e4942), body]);
  const gltf = await new GLTFLoader().parseAsync(Uint8Array.from(bytes).buffer, "");
  require(Buffer.from(await embeddedPvs(gltf)).equals(file), "the file in the .glb");
}

async function the_documents_show_what_works() {
  const name = join(dirname(fileURLToPath(import.meta.url)), "show_three.mjs");
  const shown = readFileSync(name, "utf8").match(/\/\* \[three \*\/\n(.*?)\/\* three\] \*\//s)[1];
  require(readFileSync(join(folder, "README.md"), "utf8").includes(`\`\`\`js\n${shown}\`\`\``), "README.md");
  copyFileSync(name, join(project, "show_three.mjs"));
  const { cullScene } = await import(pathToFileURL(join(project, "show_three.mjs")).href);
  const gltf = await load_scene();
  const update = await cullScene(gltf, pathToFileURL(join(town, "town.pvs")));
  require(update(camera_at(answers[0].eye)).cell === 0, "the cell");
  const drawn = drawn_of(THREE, gltf.scene, camera_of_all());
  same(drawn.polygons, expected_of(answers[0], whole_in_ranges), "the page of the README.md");
}

const objects = await draws_the_answers("objects", () => true);
const ranges = await draws_the_answers("ranges", whole_in_ranges);
await draws_the_answers("ranges", whole_in_ranges, ({ scene, parser }) => ({ scene: scene.clone(), parser }));
const packed = await draws_the_answers("packed", whole_in_ranges);
require(ranges < objects && packed === ranges, `${ranges} and ${packed} calls with ranges and packed, ${objects} with objects`);
await packed_batches_cast_shadows();
await packed_batches_have_attributes();
await batches_are_culled_and_cast_shadows();
await a_changed_scene_is_rejected();
await the_near_plane_is_checked();
await a_scene_is_attached_once();
await skipped_meshes_are_left();
await what_moves_stays_apart();
await the_overlay_freezes_the_set();
await the_file_in_the_scene_is_found();
await the_documents_show_what_works();
console.log(`three.js ${THREE.REVISION}: ${objects.toFixed(1)} calls with objects, ${ranges.toFixed(1)} with ranges and packed`);
