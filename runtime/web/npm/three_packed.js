// The batches of mode "packed" (three.d.ts).
import { BufferAttribute, BufferGeometry, Matrix3, Mesh, Vector3, Vector4 } from 'three';

// What is in the space of the scene afterwards: floats, also where the scene is quantized.
const transformed = ['position', 'normal', 'tangent'];

/** Writes an attribute of the vertices `used` of a draw, from vertex `at` on. */
function transform(name, from, used, matrix, to, at) {
  const normals = new Matrix3().getNormalMatrix(matrix), vector = new Vector3(), tangent = new Vector4();
  for (const i of used) {
    if (!transformed.includes(name)) {
      for (let k = 0; k < from.itemSize; ++k) to.setComponent(at, k, from.getComponent(i, k));
    } else if (name === 'tangent') {
      tangent.fromBufferAttribute(from, i);
      const { x, y, z } = vector.copy(tangent).transformDirection(matrix);
      to.setXYZW(at, x, y, z, tangent.w);
    } else {
      vector.fromBufferAttribute(from, i);
      if (name === 'position') vector.applyMatrix4(matrix);
      else vector.applyMatrix3(normals).normalize();
      to.setXYZ(at, vector.x, vector.y, vector.z);
    }
    ++at;
  }
}

/** The draws of one material as one mesh in the space of the scene. Its index buffer begins with the visible polygons; all
 * polygons follow, which shadows take and sets are copied from. */
export class PackedBatch {
  parts = [];  // of each draw: { geometry, matrix, used: its vertices, at: their first place, indices }
  starts = [];  // by draw: its first index in the list
  list = null;  // the index buffer
  vertexCount = 0;
  indexCount = 0;
  count = 0;  // indices of visible polygons

  constructor(mesh) { this.like = mesh; }

  add(number, { geometry }, matrix, triangles) {
    const { index } = geometry;
    const places = new Map();  // vertices that no triangle uses are left out: primitives may share one large buffer
    const indices = new Uint32Array(3 * triangles.length);
    triangles.forEach((triangle, i) => {
      for (let k = 0; k < 3; ++k) {
        const corner = index === null ? 3 * triangle + k : index.getX(3 * triangle + k);
        if (!places.has(corner)) places.set(corner, this.vertexCount + places.size);
        indices[3 * i + k] = places.get(corner);
      }
    });
    this.starts[number] = this.indexCount;
    this.parts.push({ geometry, matrix, used: Array.from(places.keys()), at: this.vertexCount, indices });
    this.vertexCount += places.size;
    this.indexCount += indices.length;
  }

  build() {
    const { like, parts, indexCount: all } = this;
    const geometry = new BufferGeometry();
    for (const [name, { array, itemSize, normalized }] of Object.entries(like.geometry.attributes)) {
      const floats = transformed.includes(name);
      const values = new (floats ? Float32Array : array.constructor)(itemSize * this.vertexCount);
      const to = new BufferAttribute(values, itemSize, normalized && !floats);
      for (const { geometry: { attributes }, used, matrix, at } of parts) {
        transform(name, attributes[name], used, matrix, to, at);
      }
      geometry.setAttribute(name, to);
    }
    this.list = new Uint32Array(2 * all);
    parts.reduce((at, { indices }) => (this.list.set(indices, at), at + indices.length), all);
    this.starts = this.starts.map((start) => start + all);
    geometry.setIndex(new BufferAttribute(this.list, 1));
    geometry.computeBoundingSphere();
    this.parts = null;
    this.mesh = new Mesh(geometry, like.material);
    // What the camera does not see can cast a shadow that it sees.
    this.mesh.onBeforeShadow = () => geometry.setDrawRange(all, all);
    this.mesh.onAfterShadow = () => geometry.setDrawRange(0, this.count);
  }

  clear() { this.count = 0; }

  push(draw, first, count) {
    const start = this.starts[draw] + 3 * first;
    this.list.copyWithin(this.count, start, start + 3 * count);
    this.count += 3 * count;
  }

  finish() {
    const { geometry } = this.mesh;
    geometry.setDrawRange(0, this.count);
    if (this.count === 0) return;
    geometry.index.clearUpdateRanges();
    geometry.index.addUpdateRange(0, this.count);
    geometry.index.needsUpdate = true;
  }

  dispose() {
    this.mesh.removeFromParent();
    this.mesh.geometry.dispose();
  }
}
