// The batches of mode "ranges" (three.d.ts).
import { BatchedMesh, BufferAttribute, BufferGeometry, Frustum, Matrix4, Sphere } from 'three';

/** A geometry whose triangles are in stored order. */
function inStoredOrder(geometry, triangles) {
  const { index } = geometry;
  const list = new Uint32Array(3 * triangles.length);
  triangles.forEach((triangle, i) => {
    for (let k = 0; k < 3; ++k) list[3 * i + k] = index === null ? 3 * triangle + k : index.getX(3 * triangle + k);
  });
  const result = new BufferGeometry();
  for (const [name, attribute] of Object.entries(geometry.attributes)) result.setAttribute(name, attribute);
  result.setIndex(new BufferAttribute(list, 1));
  return result;
}

/** The draws of one material, in one BatchedMesh. Its instances are all hidden: the function that orders what it draws puts
 * the ranges there. So no member is used that is private to three.js and moves between its releases. */
export class RangesBatch {
  parts = new Map();  // geometry -> its permutations: { triangles, geometry, draws }
  items = [];  // ranges, of which the first `count` are drawn
  count = 0;
  all = [];  // one item for each draw, for shadows
  draws = new Map();  // draw -> its item of `all`
  frustum = new Frustum();
  matrix = new Matrix4();

  constructor(mesh) { this.like = mesh; }

  add(number, mesh, matrix, triangles) {
    if (!this.parts.has(mesh.geometry)) this.parts.set(mesh.geometry, []);
    const permutations = this.parts.get(mesh.geometry);
    // One for all draws of a primitive, unless the file was baked with --order per-instance.
    let part = permutations.find((each) => each.triangles.every((triangle, i) => triangle === triangles[i]));
    if (part === undefined) {
      part = { triangles, geometry: inStoredOrder(mesh.geometry, triangles), draws: [] };
      permutations.push(part);
    }
    part.draws.push({ number, matrix });
  }

  build(rangeBound) {
    const parts = Array.from(this.parts.values()).flat();
    const sum = (count) => parts.reduce((total, part) => total + count(part), 0);
    const polygons = sum(({ draws, triangles }) => draws.length * triangles.length);
    const capacity = Math.max(sum(({ draws }) => draws.length), Math.min(rangeBound, polygons));
    const { like } = this;
    this.mesh = new BatchedMesh(capacity, sum(({ geometry }) => geometry.attributes.position.count),
      sum(({ geometry }) => geometry.index.count), like.material);
    this.mesh.perObjectFrustumCulled = false;
    let start = 0;
    for (const { geometry, draws, triangles } of parts) {
      const id = this.mesh.addGeometry(geometry);
      geometry.computeBoundingSphere();
      for (const { number, matrix } of draws) {
        const index = this.mesh.addInstance(id);
        this.mesh.setMatrixAt(index, matrix);
        this.mesh.setVisibleAt(index, false);
        const sphere = new Sphere().copy(geometry.boundingSphere).applyMatrix4(matrix);
        const item = { start, count: 3 * triangles.length, z: 0, index, sphere };
        this.draws.set(number, item);
        this.all.push(item);
      }
      start += geometry.index.count;
    }
    this.mesh.computeBoundingSphere();
    const batch = this;
    this.mesh.setCustomSort((list, camera) => this.fill(list, camera, this.items, this.count));
    // What the camera does not see can cast a shadow that it sees.
    this.mesh.onBeforeShadow = function (...args) {
      this.setCustomSort((list, camera) => batch.fill(list, camera, batch.all, batch.all.length));
      BatchedMesh.prototype.onBeforeShadow.apply(this, args);
      this.setCustomSort((list, camera) => batch.fill(list, camera, batch.items, batch.count));
    };
  }

  clear() { this.count = 0; }

  push(draw, first, count) {
    const { start, index, sphere } = this.draws.get(draw);
    if (this.count === this.items.length) this.items.push({ start: 0, count: 0, z: 0, index: 0, sphere: null });
    const item = this.items[this.count++];  // not Object.assign(), with which an update takes twice as long
    item.start = start + 3 * first;
    item.count = 3 * count;
    item.index = index;
    item.sphere = sphere;
  }

  finish() {}

  /** Lists what the BatchedMesh draws: the items whose draws are in the frustum. */
  fill(list, camera, items, count) {
    const { frustum, matrix } = this;
    if (!camera.isArrayCamera) {
      matrix.multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse).multiply(this.mesh.matrixWorld);
      frustum.setFromProjectionMatrix(matrix, camera.coordinateSystem, camera.reversedDepth);
    }
    list.length = 0;
    for (let i = 0, sphere, inside; i < count; ++i) {
      const item = items[i];
      if (item.sphere !== sphere) {
        ({ sphere } = item);
        inside = camera.isArrayCamera || frustum.intersectsSphere(sphere);
      }
      if (inside) list.push(item);
    }
  }

  dispose() {
    this.mesh.removeFromParent();
    this.mesh.dispose();
  }
}
