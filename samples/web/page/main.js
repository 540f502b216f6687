// A walk through a town with and without its PVS. What a page of its own needs is in openTown(): the rest is a person who
// walks, a panel and light.
import { ACESFilmicToneMapping, Group, PerspectiveCamera, Scene, Vector3, WebGLRenderer } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { Sightcell } from 'sightcell';
import { attach } from 'sightcell/three';
import { DebugOverlay } from 'sightcell/three/overlay';

import { Controls } from './controls.js';
import { Headset } from './headset.js';
import { Panel } from './panel.js';
import { addSurroundings } from './surroundings.js';
import { eyeHeight, Walker } from './walker.js';

const walkingSpeed = 2.5, runningSpeed = 7;  // meters per second
const headsetNear = 0.35;  // of the player radius: fits fields of view of up to 120 degrees for each eye

const progress = document.getElementById('progress');

async function openTown({ scene, sets }) {
  const loader = new GLTFLoader();
  const [gltf, db] = await Promise.all([
    loader.loadAsync(scene, ({ loaded, total }) => {
      if (total > 0) progress.textContent = `Loading the town: ${Math.round(100 * loaded / total)} %`;
    }),
    Sightcell.load().then((sightcell) => sightcell.openUrl(sets)),
  ]);
  gltf.scene.traverse((object) => {
    if (object.isMesh) object.castShadow = object.receiveShadow = !object.material.transparent;
  });
  const plain = gltf.scene.clone();  // the same meshes without a PVS, to compare
  plain.visible = false;
  const canDrawRanges = document.createElement('canvas').getContext('webgl2')?.getExtension('WEBGL_multi_draw');
  const pvs = await attach(gltf, db, { mode: canDrawRanges ? 'ranges' : 'packed' });
  return { town: gltf.scene, parser: gltf.parser, plain, db, pvs };
}

class Walk {
  #state = { pvs: true, frozen: false, cells: false };
  #frozenAt = null;
  #last = 0;

  constructor({ town, parser, plain, db, pvs }, site) {
    Object.assign(this, { town, parser, plain, db, pvs, site });
    this.scene = new Scene().add(town, plain);
    this.renderer = new WebGLRenderer({ canvas: document.getElementById('picture'), antialias: true });
    this.renderer.toneMapping = ACESFilmicToneMapping;
    this.renderer.shadowMap.enabled = true;
    const most = Math.min(this.renderer.capabilities.maxTextureSize, innerWidth < 600 ? 2048 : 4096);
    this.surroundings = addSurroundings(this.scene, plain, site.shadowSize ?? most);
    this.camera = new PerspectiveCamera();
    this.rig = new Group().add(this.camera);  // stands on the floor
    this.scene.add(this.rig);
    this.overlay = new DebugOverlay(pvs, town);
    this.overlay.visible = false;
    this.walker = new Walker(plain);
    this.walker.place(new Vector3(...site.start));
    const actions = { onPvs: (on) => this.set({ pvs: on }), onFreeze: () => this.freeze(),
      onCells: () => this.showCells() };
    this.panel = new Panel(plain, new URL(site.sets, document.baseURI).href, actions);
    this.controls = new Controls(this.renderer.domElement, document.querySelector('#stick i'), {
      KeyP: () => this.set({ pvs: !this.#state.pvs }), KeyF: actions.onFreeze, KeyC: actions.onCells,
    }, () => this.panel.showTouch());
    this.controls.heading = site.heading ?? 0;
    if (innerWidth < innerHeight) this.controls.pitch = 0.1;  // an upright picture has much ground
    if (matchMedia('(pointer: coarse)').matches) this.panel.showTouch();
    this.headset = new Headset(this.renderer, document.getElementById('headset'), () => this.fit());
    addEventListener('resize', () => this.fit());
    this.fit();
  }

  set(change) {
    const state = Object.assign(this.#state, change);
    this.town.visible = state.pvs;
    this.plain.visible = !state.pvs;
    this.overlay.frozen = state.frozen;
    this.overlay.visible = state.cells || state.frozen;
    this.panel.show(state);
  }

  showCells() { this.set({ cells: !this.#state.cells }); }

  /** While the set is frozen, the eye flies through everything, to look at the set from outside. */
  freeze() {
    const frozen = !this.#state.frozen;
    const { controls: { heading, pitch }, walker: { eye } } = this;
    if (frozen) {
      this.#frozenAt = { eye: eye.clone(), heading, pitch };
    } else {
      eye.copy(this.#frozenAt.eye);
      Object.assign(this.controls, { heading: this.#frozenAt.heading, pitch: this.#frozenAt.pitch });
    }
    this.set({ frozen });
  }

  /** Size of the picture, and a near plane that is within the player radius of the bake. */
  fit() {
    const { camera, renderer, headset, db: { info: { playerRadius } } } = this;
    camera.aspect = innerWidth / innerHeight;
    camera.fov = camera.aspect < 1 ? 78 : 62;
    const slope = Math.tan(camera.fov * Math.PI / 360);
    camera.near = playerRadius * (headset.presenting ? headsetNear
      : 0.99 / Math.sqrt(1 + slope ** 2 * (1 + camera.aspect ** 2)));
    camera.far = this.surroundings.far;
    camera.updateProjectionMatrix();
    if (headset.presenting) return;
    renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    renderer.setSize(innerWidth, innerHeight);
  }

  #walk(seconds) {
    const { camera, controls, headset, rig, walker } = this;
    if (headset.presenting) {
      headset.walk(rig, camera, walker, walkingSpeed, seconds);
    } else {
      const [right, ahead] = controls.wish;
      const { frozen } = this.#state;
      const step = seconds * (controls.running ? runningSpeed : walkingSpeed) * (frozen ? 4 : 1);
      rig.rotation.y = controls.heading;
      camera.rotation.set(controls.pitch, 0, 0);
      const way = new Vector3(right * step, 0, -ahead * step);
      if (frozen) walker.eye.add(way.applyEuler(camera.rotation).applyEuler(rig.rotation));
      else walker.move(way.applyEuler(rig.rotation), seconds);
      rig.position.x = walker.eye.x;
      rig.position.z = walker.eye.z;
      camera.position.set(0, eyeHeight, 0);
    }
    rig.position.y = walker.eye.y - eyeHeight;
  }

  frame(time) {
    const seconds = Math.min(0.05, Math.max(0, time - this.#last) / 1000);  // after a pause, too
    this.#last = time;
    this.#walk(seconds);
    this.draw();
    this.panel.update(time, this.camera, this.drawn, this.pvs.view.frame);
  }

  /** What the last picture took, without the sky. */
  get drawn() {
    const { calls, triangles } = this.renderer.info.render;
    return { calls: calls - 1, triangles: triangles - this.surroundings.skyTriangles };
  }

  /** Draws with the set of where the camera is. */
  draw() {
    const { camera, headset, overlay, renderer, rig, scene, surroundings, walker } = this;
    rig.updateMatrixWorld(true);
    if (headset.presenting) renderer.xr.updateCamera(camera);
    surroundings.follow(walker.eye);
    const frame = overlay.update(headset.presenting ? renderer.xr.getCamera() : camera);
    renderer.render(scene, camera);
    return frame;
  }

  run() { this.renderer.setAnimationLoop((time) => this.frame(time)); }
  pause() { this.renderer.setAnimationLoop(null); }
}

try {
  const site = await (await fetch('site.json')).json();
  const walk = new Walk(await openTown(site), site);
  walk.run();
  document.getElementById('loading').remove();
  globalThis.walk = walk;  // for the console, and for tests
} catch (error) {
  progress.textContent = error.message;
  document.getElementById('loading').classList.add('failed');
  throw error;
}
