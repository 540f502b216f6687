// Lines over the picture of three.js that show why it has what it has. See three_overlay.d.ts.
import { BufferAttribute, BufferGeometry, Color, LineBasicMaterial, LineSegments, Vector3 } from 'three';

import { DebugLines } from './sightcell.js';

const colors = new Map([
  [DebugLines.cell, new Color(0xffd21f)],
  [DebugLines.kept, new Color(0xff7a1a)],
  [DebugLines.neighbors, new Color(0x9aa7b4)],
  [DebugLines.volumes, new Color(0x3fa7ff)],
  [DebugLines.outsideRegion, new Color(0xff3b3b)],
]);
const cameraColor = new Color(0x37e0a0);
const cameraLength = 1.5;  // meters from the eye to the frame that shows its field of view
const cameraEdges = [[0, 1], [0, 2], [0, 3], [0, 4], [1, 2], [2, 4], [4, 3], [3, 1]];

export class DebugOverlay {
  #pvs;
  #scene;
  #kinds;
  #frozen = false;
  #built = '';  // what the lines were made of
  #eye = [];  // corners of the frozen camera, in the space of the scene

  constructor(pvs, scene, { kinds = DebugLines.cell | DebugLines.kept | DebugLines.neighbors } = {}) {
    this.#pvs = pvs;
    this.#scene = scene;
    this.#kinds = kinds;
    const material = new LineBasicMaterial({ vertexColors: true, depthTest: false, transparent: true,
      toneMapped: false });
    this.lines = new LineSegments(new BufferGeometry(), material);
    this.lines.name = 'sightcell overlay';
    this.lines.renderOrder = 1000;
    this.lines.frustumCulled = false;
    this.lines.raycast = () => {};
    scene.add(this.lines);
  }

  get frozen() { return this.#frozen; }
  set frozen(frozen) { this.#frozen = frozen; }
  get kinds() { return this.#kinds; }
  set kinds(kinds) { this.#kinds = kinds; }
  get visible() { return this.lines.visible; }
  set visible(visible) { this.lines.visible = visible; }

  update(camera) {
    if (!this.#frozen) {
      this.#pvs.update(camera);
      this.#eye.length = 0;
    } else if (this.#eye.length === 0) {
      this.#keep(camera);
    }
    const { frame } = this.#pvs.view;
    const wanted = `${frame.cell} ${frame.flags & ~1} ${this.#kinds} ${this.#frozen}`;
    if (this.lines.visible && wanted !== this.#built) {
      this.#built = wanted;
      this.#build();
    }
    return frame;
  }

  #keep(camera) {
    const first = camera.isArrayCamera && camera.cameras.length > 0 ? camera.cameras[0] : camera;
    const eye = new Vector3().setFromMatrixPosition(first.matrixWorld);
    const corners = [[-1, -1], [1, -1], [-1, 1], [1, 1]].map(([x, y]) =>
      new Vector3(x, y, 0.5).unproject(first).sub(eye).setLength(cameraLength).add(eye));
    this.#eye = [eye, ...corners].map((point) => this.#scene.worldToLocal(point));
  }

  #build() {
    const { positions, kinds } = this.#pvs.view.debugLines(this.#kinds);
    const camera = this.#eye.length === 0 ? [] : cameraEdges.flat().flatMap((corner) => this.#eye[corner].toArray());
    const all = new Float32Array(positions.length + camera.length);
    all.set(positions);
    all.set(camera, positions.length);
    const shades = new Float32Array(all.length).fill(1);
    for (let end = 0; end < all.length / 3; ++end) {
      const line = end >> 1;
      (line < kinds.length ? colors.get(kinds[line]) : cameraColor).toArray(shades, 3 * end);
    }
    this.lines.geometry.dispose();  // attributes of a geometry on the GPU cannot change their length
    this.lines.geometry = new BufferGeometry();
    this.lines.geometry.setAttribute('position', new BufferAttribute(all, 3));
    this.lines.geometry.setAttribute('color', new BufferAttribute(shades, 3));
  }

  dispose() {
    this.lines.removeFromParent();
    this.lines.geometry.dispose();
    this.lines.material.dispose();
  }
}
