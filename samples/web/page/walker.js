// A person in the town: an upright capsule that keeps its distance from all surfaces, so that the eye at its upper end is a
// valid viewpoint of the bake (--player-radius).
import { Box3, BufferAttribute, BufferGeometry, Line3, Matrix4, Vector3 } from 'three';
import { MeshBVH } from 'three-mesh-bvh';

export const eyeHeight = 1.7;
const radius = 0.3;  // meters; more than the player radius of the bake
const gravity = 12;
const mostStep = 0.1;  // meters; a capsule that moves farther at once could pass through a wall

/** All triangles of a scene in one list. */
function trianglesOf(scene) {
  const meshes = [];
  scene.updateMatrixWorld(true);
  scene.traverse((object) => {
    if (object.isMesh) meshes.push(object);
  });
  const counts = meshes.map(({ geometry: { index, attributes: { position } } }) => (index ?? position).count);
  const positions = new Float32Array(3 * counts.reduce((sum, count) => sum + count, 0));
  const point = new Vector3();
  let at = 0;
  meshes.forEach(({ geometry: { index, attributes: { position } }, matrixWorld }, i) => {
    for (let k = 0; k < counts[i]; ++k, at += 3) {
      point.fromBufferAttribute(position, index === null ? k : index.getX(k));
      point.applyMatrix4(matrixWorld).toArray(positions, at);
    }
  });
  return new BufferGeometry().setAttribute('position', new BufferAttribute(positions, 3));
}

export class Walker {
  eye = new Vector3();
  #bvh;
  #fall = 0;
  #standing = false;
  #box = new Box3();
  #segment = new Line3();
  #onTriangle = new Vector3();
  #onSegment = new Vector3();

  constructor(scene) { this.#bvh = new MeshBVH(trianglesOf(scene)); }

  /** Puts the eye above the floor that is below this point. */
  place(point) {
    this.eye.copy(point);
    this.#fall = 0;
    for (let i = 0; i < 600 && !this.#standing; ++i) this.move(new Vector3(), 1 / 60);
  }

  /** Whether the eye keeps this distance from all surfaces. */
  isClear(point, distance) {
    const nearest = this.#bvh.closestPointToPoint(point, {}, 0, distance);
    return nearest === null || nearest.distance >= distance;
  }

  /** way: meters along the floor. */
  move(way, seconds) {
    const before = this.eye.clone();
    this.#fall = this.#standing ? 0 : this.#fall - gravity * seconds;
    const whole = new Vector3(way.x, (this.#fall - 0.5) * seconds, way.z);
    const steps = Math.ceil(whole.length() / mostStep);
    this.#standing = false;
    for (let i = 0; i < steps; ++i) {
      this.eye.addScaledVector(whole, 1 / steps);
      this.#pushOut();
    }
    if (this.eye.y < this.#bvh.getBoundingBox(this.#box).min.y - 10) this.eye.copy(before);  // beyond the town
  }

  #pushOut() {
    const { start, end } = this.#segment;
    end.copy(this.eye);
    start.copy(this.eye);
    start.y -= eyeHeight - radius;
    const box = this.#box.setFromPoints([start, end]).expandByScalar(radius);
    const height = end.y;
    this.#bvh.shapecast({
      intersectsBounds: (bounds) => bounds.intersectsBox(box),
      intersectsTriangle: (triangle) => {
        const distance = triangle.closestPointToSegment(this.#segment, this.#onTriangle, this.#onSegment);
        if (distance >= radius || distance === 0) return;
        const out = this.#onSegment.sub(this.#onTriangle).multiplyScalar((radius - distance) / distance);
        start.add(out);
        end.add(out);
        if (out.y > 0.5 * out.length()) this.#standing = true;
      },
    });
    this.eye.copy(end);
    if (end.y > height) this.#fall = 0;
  }
}
