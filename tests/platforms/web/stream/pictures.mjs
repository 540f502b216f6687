// Pictures in the browser: a lit scene, its pixels, and how many of them differ from those of another.
import * as THREE from "three";

export const width = 640,
  height = 360;
export const renderer = new THREE.WebGLRenderer();
export const camera = new THREE.PerspectiveCamera(60, width / height, 0.05, 100);
const canvas = new OffscreenCanvas(width, height).getContext("2d", { willReadFrequently: true });
renderer.setSize(width, height);
document.body.append(renderer.domElement);

export function lit_scene() {
  const scene = new THREE.Scene();
  scene.background = new THREE.Color(0x4488cc);
  const light = new THREE.DirectionalLight(0xffffff, 2);
  light.position.set(1, 2, 0.5);
  scene.add(light, new THREE.HemisphereLight(0xffffff, 0x445566, 3));
  return scene;
}

export function look_from([eye, at]) {
  camera.position.set(...eye);
  camera.lookAt(...at);
  camera.updateMatrixWorld(true);
}

export function pixels_of(scene) {
  renderer.render(scene, camera);
  canvas.drawImage(renderer.domElement, 0, 0);
  return canvas.getImageData(0, 0, width, height).data;
}

// Pixels of which a channel differs by more than 8 levels.
export function differing(a, b) {
  let count = 0;
  for (let i = 0; i < a.length; i += 4) {
    count += Number([0, 1, 2].some((k) => Math.abs(a[i + k] - b[i + k]) > 8));
  }
  return count;
}

export const sleep = (milliseconds) => new Promise((go) => setTimeout(go, milliseconds));

// each: called before each test of the condition.
export async function until(condition, each = () => {}) {
  const end = performance.now() + 60000;
  for (each(); !condition(); each()) {
    if (performance.now() > end) throw new Error(`not within 60 s: ${condition}`);
    await sleep(10);
  }
}
