// The panel: what is drawn, what would be drawn without the PVS, and switches.
import { Frustum, Matrix4 } from 'three';

const period = 250;  // milliseconds
const byId = (id) => document.getElementById(id);
const written = new Intl.NumberFormat('en-US');

/** Counts the bytes that arrive from an address. */
function countBytes(address) {
  const sum = { bytes: 0 };
  const observer = new PerformanceObserver((list) => {
    for (const { name, encodedBodySize } of list.getEntries()) if (name === address) sum.bytes += encodedBodySize;
  });
  observer.observe({ type: 'resource', buffered: true });
  return sum;
}

export class Panel {
  #meshes = [];
  #bytes;
  #last = 0;
  #frames = 0;
  #frustum = new Frustum();
  #matrix = new Matrix4();

  /** plain: the scene without a PVS. sets: the address of its .pvs file. */
  constructor(plain, sets, { onPvs, onFreeze, onCells }) {
    plain.traverse((object) => {
      if (object.isMesh) this.#meshes.push(object);
    });
    this.#bytes = countBytes(sets);
    byId('pvs').addEventListener('change', (event) => onPvs(event.target.checked));
    byId('freeze').addEventListener('click', onFreeze);
    byId('cells').addEventListener('click', onCells);
    byId('panel').hidden = false;
    byId('hint').hidden = false;
  }

  showTouch() {
    byId('stick').hidden = false;
    byId('hint').hidden = true;
  }

  show({ pvs, frozen, cells }) {
    byId('pvs').checked = pvs;
    byId('freeze').setAttribute('aria-pressed', frozen);
    byId('cells').setAttribute('aria-pressed', cells);
  }

  /** What three.js draws with frustum culling alone. */
  #withoutPvs(camera) {
    this.#matrix.multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse);
    this.#frustum.setFromProjectionMatrix(this.#matrix, camera.coordinateSystem, camera.reversedDepth);
    let calls = 0, triangles = 0;
    for (const mesh of this.#meshes) {
      if (!this.#frustum.intersectsObject(mesh)) continue;
      ++calls;
      triangles += (mesh.geometry.index ?? mesh.geometry.attributes.position).count / 3 * (mesh.count ?? 1);
    }
    return { calls, triangles };
  }

  update(time, camera, { calls, triangles }, frame) {
    ++this.#frames;
    if (time - this.#last < period) return;
    const off = this.#withoutPvs(camera);
    const texts = { calls, triangles, 'calls-off': off.calls, 'triangles-off': off.triangles,
      rate: Math.round(1000 * this.#frames / (time - this.#last)) };
    for (const [id, number] of Object.entries(texts)) byId(id).textContent = written.format(number);
    byId('cell').textContent = frame.outside ? 'none' : `${frame.cell}${frame.pending ? ', loading' : ''}`;
    byId('bytes').textContent = `${written.format(Math.ceil(this.#bytes.bytes / 1000))} KB`;
    byId('share').style.width = `${100 * Math.min(1, triangles / Math.max(1, off.triangles))}%`;
    this.#last = time;
    this.#frames = 0;
  }
}
