// Scenes of users in Chromium, as GLTFLoader loads them, with compression: sightcell/three finds the mesh of each draw, and
// what it draws costs this much. Bakes a few cells of each scene, or takes a .pvs file beside it.
// usage: bench_scenes.mjs SIGHTCELL PACKAGE_FOLDER NODE_MODULES SCENE.glb[=FILE.pvs] ...    SIGHTCELL: the program
import { execFileSync } from "node:child_process";
import { copyFileSync, cpSync, mkdirSync, mkdtempSync, rmSync, symlinkSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { basename, join, resolve } from "node:path";

import { open_page, with_chromium } from "./chromium.mjs";
import { serve } from "./static_server.mjs";

const [program, folder, modules, ...scenes] = process.argv.slice(2);
const site = mkdtempSync(join(tmpdir(), "sightcell-bench-"));
process.on("exit", () => rmSync(site, { recursive: true }));
cpSync(folder, join(site, "sightcell"), { recursive: true });
symlinkSync(resolve(modules, "three"), join(site, "three"));
mkdirSync(join(site, "scenes"));
const imports = { three: "./three/build/three.module.js", "three/addons/": "./three/examples/jsm/",
  sightcell: "./sightcell/sightcell.js", "sightcell/three": "./sightcell/three.js" };
writeFileSync(join(site, "index.html"), `<!doctype html><link rel="icon" href="data:,">
<script type="importmap">${JSON.stringify({ imports })}</script><script type="module" src="page.js"></script>`);
writeFileSync(join(site, "page.js"), `
import { PerspectiveCamera } from "three";
import { DRACOLoader } from "three/addons/loaders/DRACOLoader.js";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { MeshoptDecoder } from "three/addons/libs/meshopt_decoder.module.js";
import { Sightcell } from "sightcell";
import { attach } from "sightcell/three";

const draco = new DRACOLoader().setDecoderPath("./three/examples/jsm/libs/draco/gltf/");
const loader = new GLTFLoader().setDRACOLoader(draco).setMeshoptDecoder(MeshoptDecoder);
const at = (list, share) => list.sort((a, b) => a - b)[Math.floor(share * (list.length - 1))];

globalThis.measure = async (name, mode) => {
  const gltf = await loader.loadAsync("scenes/" + name + ".glb");
  const sightcell = await Sightcell.load();
  const db = await sightcell.openUrl("scenes/" + name + ".pvs", { whole: true });
  const pvs = await attach(gltf, db, { mode });
  const view = db.createView(), camera = new PerspectiveCamera(60, 16 / 9, 0.03, 1000);
  const times = { move: [], change: [], same: [] };
  let calls = 0, triangles = 0, cells = 0;
  const timed = (list, work) => {
    const start = performance.now();
    work();
    list.push(performance.now() - start);
  };
  const step = Math.max(1, Math.floor(db.info.cellCount / 250));
  for (let cell = 0; cell < db.info.cellCount; cell += step, ++cells) {
    const { min, max } = db.cellBox(cell);
    camera.position.set(...min.map((end, axis) => 0.5 * (end + max[axis])));
    timed(times.move, () => view.move(camera.position));
    timed(times.change, () => pvs.update(camera));
    timed(times.same, () => pvs.update(camera));
    gltf.scene.traverse((mesh) => {
      if (!mesh.isMesh || !mesh.visible || !mesh.layers.test(camera.layers)) return;
      ++calls;
      const { index, drawRange, attributes } = mesh.geometry;
      if (!mesh.isBatchedMesh) triangles += Math.min(drawRange.count, (index ?? attributes.position).count) / 3 * (mesh.count ?? 1);
    });
  }
  pvs.dispose();
  return { draws: db.draws.length, polygons: db.info.polygonCount, cells, calls: calls / cells, triangles: triangles / cells,
    move_ms_p95: at(times.move, 0.95), change_ms_p50: at(times.change, 0.5), change_ms_p95: at(times.change, 0.95),
    same_ms_p95: at(times.same, 0.95) };
};
globalThis.ready = true;
`);

/** Cells of a grid that spans the scene. */
function bake(scene, pvs) {
  const { bounds: { min, max } } = JSON.parse(execFileSync(program, ["info", scene, "--json"], { maxBuffer: 1 << 26 }));
  const size = Math.max(...max.map((end, axis) => end - min[axis])) / 8;
  execFileSync(program, ["bake", scene, "-o", pvs, `--cells-grid=${[...min, ...max].join()}`, "--cell-size", size, "--cell-limit",
    12, "--quality", "draft", "--progress", "none"], { stdio: "ignore" });
}

// So that the clock of the page has steps of 5 us.
const server = await serve(site, { "Cross-Origin-Opener-Policy": "same-origin", "Cross-Origin-Embedder-Policy": "require-corp" });
try {
  await with_chromium(modules, async (browser) => {
    for (const given of scenes) {
      const [scene, file] = given.split("=");
      const name = basename(scene, ".glb"), pvs = join(site, "scenes", `${name}.pvs`);
      copyFileSync(scene, join(site, "scenes", `${name}.glb`));
      if (file === undefined) bake(scene, pvs);
      else copyFileSync(file, pvs);
      for (const mode of ["objects", "ranges", "packed"]) {
        const { page, no_problems, close } = await open_page(browser, server.url);
        await page.waitForFunction(() => globalThis.ready);
        const found = await page.evaluate(([n, m]) => globalThis.measure(n, m), [name, mode]);
        no_problems();
        await close();
        console.log(JSON.stringify({ scene: name, mode, ...found }, (_, value) =>
          (typeof value === "number" ? Math.round(1000 * value) / 1000 : value)));
      }
    }
  });
} finally {
  server.close();
}
