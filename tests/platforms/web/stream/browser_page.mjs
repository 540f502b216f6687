// Runs in the browser: pictures of the streamed scene, and of the whole .glb by GLTFLoader.
import * as THREE from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { stream } from "sightcell-stream";
import { showSite } from "/test/show.mjs";

const width = 640,
  height = 360;
const renderer = new THREE.WebGLRenderer();
renderer.setSize(width, height);
document.body.append(renderer.domElement);
const camera = new THREE.PerspectiveCamera(60, width / height, 0.05, 100);
const canvas = new OffscreenCanvas(width, height).getContext("2d", { willReadFrequently: true });

function lit_scene() {
  const scene = new THREE.Scene();
  scene.background = new THREE.Color(0x4488cc);
  const light = new THREE.DirectionalLight(0xffffff, 2);
  light.position.set(1, 2, 0.5);
  scene.add(light, new THREE.HemisphereLight(0xffffff, 0x445566, 3));
  return scene;
}

function pixels_of(scene) {
  renderer.render(scene, camera);
  canvas.drawImage(renderer.domElement, 0, 0);
  return canvas.getImageData(0, 0, width, height).data;
}

async function until(condition) {
  const end = performance.now() + 60000;
  while (!condition()) {
    if (performance.now() > end) throw new Error(`not within 60 s: ${condition}`);
    await new Promise((go) => setTimeout(go, 10));
  }
}

// Pixels of which a channel differs by more than 8 levels.
function differing(a, b) {
  let count = 0;
  for (let i = 0; i < a.length; i += 4) {
    count += Number([0, 1, 2].some((k) => Math.abs(a[i + k] - b[i + k]) > 8));
  }
  return count;
}

// For each pose: the wrong pixels, those without any polygon, and draw calls of both. shown: pictures for a person.
globalThis.compare = async (site, glb, poses, files) => {
  const scene = lit_scene(),
    whole = lit_scene();
  whole.add((await new GLTFLoader().loadAsync(glb)).scene);
  const errors = [];
  let streamed;
  const out = { poses: [], shown: [] };
  for (const [eye, look] of poses) {
    camera.position.set(...eye);
    camera.lookAt(...look);
    camera.updateMatrixWorld(true);
    streamed ??= await stream(site, scene, camera, { onError: (error) => errors.push(error.message) });
    streamed.update(camera);
    await until(() => streamed.complete);
    // The largest images come after the cell is complete.
    const largest = () =>
      files.every((name) => performance.getEntriesByName(new URL(name, new URL(site, location))).length > 0);
    await until(largest);
    await new Promise((go) => setTimeout(go, 200));
    const before = pixels_of(scene),
      calls = renderer.info.render.calls;
    out.shown.push(renderer.domElement.toDataURL());
    const expected = pixels_of(whole);
    out.poses.push({
      cell: streamed.cell,
      wrong: differing(before, expected),
      calls,
      whole_calls: renderer.info.render.calls,
    });
  }
  // A moved group is drawn where it is.
  streamed.group.position.x += 0.5;
  camera.position.x += 0.5;
  out.moved = differing(pixels_of(scene), pixels_of(((whole.children.at(-1).position.x += 0.5), whole)));
  streamed.dispose();
  out.memory = { ...renderer.info.memory };
  out.errors = errors;
  return out;
};

// What is left on the device after a site is opened and disposed again and again.
globalThis.open_and_dispose = async (site, times) => {
  const memory = [];
  for (let i = 0; i < times; ++i) {
    const scene = lit_scene();
    const streamed = await showSite(site, renderer, scene, camera);
    await until(() => streamed.complete);
    renderer.render(scene, camera);
    renderer.setAnimationLoop(null);
    streamed.dispose();
    memory.push(`${renderer.info.memory.geometries} ${renderer.info.memory.textures}`);
  }
  return memory;
};
