// The camera in the space of a streamed scene: where it is and goes, and what it sees.
import { Frustum, Matrix4, Vector3 } from 'three';

const fastest = 100;  // meters per second: a faster camera has jumped
const parts = 8;  // of a sector of 45 degrees of headings
const middles = Array.from({ length: 8 * parts }, (_, i) => {
  const heading = ((i + 0.5) * Math.PI) / (4 * parts);
  return [Math.cos(heading), Math.sin(heading)];
});

export class CameraView {
  eye = new Vector3();
  velocity = new Vector3();
  sectors = new Float32Array(8);  // how much of each sector of headings is in the view, 0 to 1
  #matrix = new Matrix4();
  #next = new Matrix4();
  #last = new Vector3();
  #frustum = new Frustum();
  #time = 0;
  #camera;
  sees = (box) =>
    this.#frustum.intersectsBox({ min: { x: box[0], y: box[1], z: box[2] }, max: { x: box[3], y: box[4], z: box[5] } });

  constructor(seconds) {
    this.seconds = seconds;
    this.#matrix.elements[0] = NaN;  // equals no other
  }

  /** Returns whether anything has changed. */
  move(camera, group, now) {
    // One eye of a headset stands for both: they are in the grown cell. Three.js writes its matrices itself.
    const isHeadset = camera.isArrayCamera === true && camera.cameras.length > 0;
    if (isHeadset) [camera] = camera.cameras;
    else camera.updateWorldMatrix(true, false);
    this.#camera = camera;
    group.updateWorldMatrix(true, false);
    this.#next.multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse).multiply(group.matrixWorld);
    const passed = (now - this.#time) / 1000;
    this.#time = now;
    if (this.#next.equals(this.#matrix)) {
      this.velocity.set(0, 0, 0);
      return false;
    }
    this.#matrix.copy(this.#next);
    this.#last.copy(this.eye);
    group.worldToLocal(this.eye.setFromMatrixPosition(camera.matrixWorld));
    this.#last.subVectors(this.eye, this.#last).divideScalar(Math.max(passed, 1e-3));
    if (passed > 0.5 || this.#last.length() > fastest) this.velocity.set(0, 0, 0);
    else this.velocity.lerp(this.#last, Math.min(1, passed / 0.2));
    return true;
  }

  /** Prepares `sees` and `sectors`. */
  look() {
    const { coordinateSystem, reversedDepth, projectionMatrix } = this.#camera;
    this.#frustum.setFromProjectionMatrix(this.#matrix, coordinateSystem, reversedDepth);
    const isPerspective = projectionMatrix.elements[15] === 0;
    this.sectors.fill(isPerspective ? 0 : 1);
    if (!isPerspective) return;
    // A part of a sector counts if a direction with the heading in its middle, up or down by any angle, is in the
    // frustum. So a view that contains the vertical has all headings.
    const sides = this.#frustum.planes.slice(0, 4);
    let along = -Infinity,
      own = 0;
    middles.forEach(([x, z], i) => {
      let low = -Infinity,
        high = Infinity,
        ahead = 0;
      for (const { normal } of sides) {
        const level = normal.x * x + normal.z * z;
        ahead += level;
        if (normal.y > 0) low = Math.max(low, -level / normal.y);
        else if (normal.y < 0) high = Math.min(high, -level / normal.y);
        else if (level <= 0) high = -Infinity;
      }
      if (low < high) this.sectors[i >> 3] += 1 / parts;
      if (ahead > along) [along, own] = [ahead, i >> 3];
    });
    // A narrow view may be between two middles.
    this.sectors[own] = Math.max(this.sectors[own], 1 / parts);
  }
}
