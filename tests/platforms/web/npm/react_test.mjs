// The example of React Three Fiber in docs/hosting.md: it draws the set of the camera's cell, follows another file, and
// leaves the scene as it was, also in StrictMode, which mounts everything twice.
// usage: react_test.mjs PACKAGE_FOLDER NODE_MODULES SCENE_FOLDER DOCUMENT
import { cpSync, mkdirSync, mkdtempSync, readdirSync, readFileSync, rmSync, symlinkSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";

import { require } from "../host.mjs";
import { drawn_of, read_glb } from "./town.mjs";

const [folder, modules, town, document] = process.argv.slice(2);
const project = mkdtempSync(join(tmpdir(), "sightcell-test-"));
process.on("exit", () => rmSync(project, { recursive: true }));
const installed = join(project, "node_modules");
mkdirSync(installed);
for (const name of readdirSync(modules)) {
  if (!name.startsWith(".") && name !== "@react-three") symlinkSync(resolve(modules, name), join(installed, name));
}
// The modules that bundlers take. Node would take those with require(), which load a three.js of their own.
const fiber = join(installed, "@react-three", "fiber");
cpSync(resolve(modules, "@react-three", "fiber"), fiber, { recursive: true });
writeFileSync(join(fiber, "package.json"), '{"type": "module", "main": "dist/react-three-fiber.esm.js"}');
cpSync(folder, join(installed, "sightcell"), { recursive: true });
const load = (name) => import(pathToFileURL(join(project, name)).href);

const text = readFileSync(join(dirname(fileURLToPath(import.meta.url)), "show_react.jsx"), "utf8");
const shown = text.match(/\/\* \[react \*\/\n(.*?)\/\* react\] \*\//s)[1];
require(readFileSync(document, "utf8").includes(`\`\`\`jsx\n${shown}\`\`\``), `${document} shows the example`);
const { default: typescript } = await load("node_modules/typescript/lib/typescript.js");
const { ModuleKind, JsxEmit, ScriptTarget } = typescript;
const { outputText } = typescript.transpileModule(text, {
  compilerOptions: { module: ModuleKind.ESNext, target: ScriptTarget.ES2022, jsx: JsxEmit.ReactJSX } });
writeFileSync(join(project, "culled.mjs"), outputText);
writeFileSync(join(project, "modules.mjs"), `export * as THREE from "three";
  export { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
  export { createRoot, advance, act, extend } from "@react-three/fiber";
  export { createElement, StrictMode } from "react";
  export { Sightcell } from "sightcell";
  export { Culled } from "./culled.mjs";`);
globalThis.IS_REACT_ACT_ENVIRONMENT = true;
const { THREE, GLTFLoader, createRoot, advance, act, extend, createElement, StrictMode, Sightcell, Culled } =
  await load("modules.mjs");
extend(THREE);
for (const level of ["warn", "error"]) {
  console[level] = (...texts) => {
    if (!String(texts[0]).startsWith("THREE.Clock")) throw new Error(`console.${level}: ${texts}`);  // of React Three Fiber
  };
}

const sightcell = await Sightcell.load();
const bytes = readFileSync(join(town, "town.pvs"));
const { buffer, byteOffset, byteLength } = read_glb(join(town, "town.glb")).bytes;
const gltf = await new GLTFLoader().parseAsync(buffer.slice(byteOffset, byteOffset + byteLength), "");
gltf.scene.updateMatrixWorld(true);
const all_around = new THREE.OrthographicCamera(-500, 500, 500, -500, -500, 500);
const all = drawn_of(THREE, gltf.scene, all_around).polygons;
const children = gltf.scene.children.length;

// A renderer that draws nothing.
const renderer = { render() {}, setSize() {}, setPixelRatio() {}, dispose() {}, forceContextLoss() {}, shadowMap: {},
  renderLists: { dispose() {} },
  xr: { enabled: false, addEventListener() {}, removeEventListener() {}, setAnimationLoop() {} } };
const camera = new THREE.PerspectiveCamera(60, 16 / 9, 0.03, 1000);
const root = createRoot({ addEventListener() {}, removeEventListener() {} });
await root.configure({ gl: renderer, camera, frameloop: "never", size: { width: 16, height: 9, top: 0, left: 0 } });
const eye_of = (db, cell) => {
  const { min, max } = db.cellBox(cell);
  return new THREE.Vector3(...min.map((end, axis) => 0.5 * (end + max[axis])));
};
const show = (element) => act(async () => { root.render(element); });
const drawn_at = (eye) => {
  camera.position.copy(eye);
  advance(0);
  return drawn_of(THREE, gltf.scene, all_around).polygons.length;
};

let files = [];
for (const strict of [false, true]) {
  for (let i = 0; i < 2; ++i) {  // another file of the same scene takes the place of the first
    const db = sightcell.open(bytes);
    files.push(db);
    const element = createElement(Culled, { gltf, db });
    await show(strict ? createElement(StrictMode, null, element) : element);
    for (const cell of [0, 1, 2]) {
      const view = db.createView();
      view.move(eye_of(db, cell));
      const polygons = view.ranges().filter((_, k) => k % 3 === 2).reduce((sum, count) => sum + count, 0);
      view.dispose();
      const drawn = drawn_at(eye_of(db, cell));
      require(drawn >= polygons && drawn < all.length, `${drawn} of ${all.length} polygons, ${polygons} in the set`);
    }
  }
  await show(null);
  const left = drawn_of(THREE, gltf.scene, all_around).polygons;
  require(left.join() === all.join() && gltf.scene.children.length === children, "the scene is as it was");
}
for (const db of files) db.dispose();
console.log(`${files.length} files`);
process.exit(0);
