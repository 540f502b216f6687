// The camera in the space of a streamed scene: where it is and goes, and what it sees.
import { Frustum, Matrix4, Vector3, Vector4 } from 'three';

const fastest = 100;  // meters per second: a faster camera has jumped
const samplesAcross = 33;  // of the horizontal angle of view

export class CameraView {
  eye = new Vector3();
  velocity = new Vector3();
  headings = 255;
  #matrix = new Matrix4();
  #next = new Matrix4();
  #last = new Vector3();
  #frustum = new Frustum();
  #point = new Vector4();
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

  /** Prepares `sees` and `headings`. */
  look() {
    const { coordinateSystem, reversedDepth } = this.#camera;
    this.#frustum.setFromProjectionMatrix(this.#matrix, coordinateSystem, reversedDepth);
    const isInside = (x, y, z, w) => {
      const p = this.#point.set(x, y, z, w).applyMatrix4(this.#matrix);
      return p.w > 0 && Math.abs(p.x) <= p.w && Math.abs(p.y) <= p.w;
    };
    this.headings = 255;
    // A view that contains the vertical shows all headings.
    if (isInside(0, 1, 0, 0) || isInside(0, -1, 0, 0)) return;
    const inverse = this.#next.copy(this.#matrix).invert();
    this.headings = 0;
    for (let i = 0; i < samplesAcross; ++i) {
      for (const y of [-1, 0, 1]) {
        const p = this.#point
          .set((2 * i) / (samplesAcross - 1) - 1, y, 0.5, 1)
          .applyMatrix4(inverse)
          .divideScalar(this.#point.w);
        const angle = Math.atan2(p.z - this.eye.z, p.x - this.eye.x) / (Math.PI / 4);
        this.headings |= 1 << ((Math.floor(angle) + 8) % 8);
      }
    }
  }
}
