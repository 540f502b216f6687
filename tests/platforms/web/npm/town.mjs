// The polygons of a .glb in the order of source ids, and those that three.js would draw of a scene: without the adapter's
// search for objects, so that they can judge it. A polygon is the text of its corners in world space.
import { readFileSync } from "node:fs";

const corner = (vector) => vector.toArray().map((end) => (Math.round(end * 1000) / 1000 + 0).toFixed(3)).join(" ");

// The corners may begin anywhere, but their order is the front of the polygon.
function text_of(a, b, c) {
  const corners = [a, b, c].map(corner);
  const least = corners.indexOf(corners.slice().sort()[0]);
  return [0, 1, 2].map((i) => corners[(least + i) % 3]).join("; ");
}

export function read_glb(path) {
  const bytes = readFileSync(path);
  const size = bytes.readUInt32LE(12);
  return { json: JSON.parse(bytes.subarray(20, 20 + size)), binary: bytes.subarray(28 + size), bytes };
}

function rows_of({ json, binary }, number) {
  const { bufferView, byteOffset = 0, componentType, count, type } = json.accessors[number];
  const { byteOffset: begin = 0 } = json.bufferViews[bufferView];
  const width = { SCALAR: 1, VEC3: 3, VEC4: 4 }[type];
  const [size, read] = { 5123: [2, "readUInt16LE"], 5125: [4, "readUInt32LE"], 5126: [4, "readFloatLE"] }[componentType];
  return Array.from({ length: count }, (_, i) => Array.from({ length: width },
    (_, k) => binary[read](begin + byteOffset + size * (width * i + k))));
}

// Nodes depth-first, primitives, instances, triangles. Each polygon has the number of its draw's place in this order.
export function polygons_of(THREE, glb) {
  const { json } = glb;
  const list = [];
  const compose = (t = [0, 0, 0], r = [0, 0, 0, 1], s = [1, 1, 1]) => new THREE.Matrix4().compose(
    new THREE.Vector3(...t), new THREE.Quaternion(...r), new THREE.Vector3(...s));
  const visit = (number, above) => {
    const node = json.nodes[number];
    const matrix = above.clone().multiply(compose(node.translation, node.rotation, node.scale));
    const { attributes } = node.extensions?.EXT_mesh_gpu_instancing ?? {};
    const [t, r, s] = ["TRANSLATION", "ROTATION", "SCALE"].map((key) => attributes && rows_of(glb, attributes[key]));
    const instances = attributes ? t.map((_, i) => matrix.clone().multiply(compose(t[i], r[i], s[i]))) : [matrix];
    (json.meshes[node.mesh]?.primitives ?? []).forEach((primitive, p) => instances.forEach((instance, i) => {
      const mirrored = instance.determinant() < 0;
      const points = rows_of(glb, primitive.attributes.POSITION).map((row) => new THREE.Vector3(...row).applyMatrix4(instance));
      const indices = rows_of(glb, primitive.indices).flat();
      for (let at = 0; at < indices.length; at += 3) {
        const corners = indices.slice(at, at + 3).map((index) => points[index]);
        if (mirrored) corners.reverse();  // three.js turns the front of a mirrored mesh
        list.push({ text: text_of(...corners), corners, draw: `${number} ${p} ${i}`, material: primitive.material });
      }
    }));
    (node.children ?? []).forEach((child) => visit(child, matrix));
  };
  json.scenes[0].nodes.forEach((number) => visit(number, new THREE.Matrix4()));
  return list;
}

// What a renderer would draw: for each object the ranges of indices with their matrices, after the same calls.
function* drawn_parts(THREE, object, scene, camera, shadow) {
  if (object.isBatchedMesh) {
    const { geometry, material } = object;
    if (shadow) object.onBeforeShadow({}, object, camera, camera, geometry, material, null);
    else object.onBeforeRender({}, scene, camera, geometry, material, null);
    const size = geometry.index.array.BYTES_PER_ELEMENT;
    for (let i = 0; i < object._multiDrawCount; ++i) {
      const matrix = object.getMatrixAt(object._indirectTexture.image.data[i], new THREE.Matrix4());
      yield [object._multiDrawStarts[i] / size, object._multiDrawCounts[i], matrix.premultiply(object.matrixWorld)];
    }
  } else if (object.isInstancedMesh) {
    for (let i = 0; i < object.count; ++i) {
      const matrix = object.matrixWorld.clone().multiply(new THREE.Matrix4().fromArray(object.instanceMatrix.array, 16 * i));
      yield [0, object.geometry.index.count, matrix];
    }
  } else {
    if (shadow) object.onBeforeShadow();
    const { start, count } = object.geometry.drawRange;
    yield [start, Math.min(count, object.geometry.index.count - start), object.matrixWorld];
    if (shadow) object.onAfterShadow();
  }
}

// { polygons: sorted texts, calls, ranges }
export function drawn_of(THREE, scene, camera, { shadow = false } = {}) {
  const drawn = { polygons: [], calls: 0, ranges: 0 };
  scene.updateMatrixWorld(true);
  camera.updateMatrixWorld(true);
  const visit = (object) => {
    if (!object.visible) return;
    if (object.isMesh && object.layers.test(camera.layers)) {
      ++drawn.calls;
      const { index, attributes: { position } } = object.geometry;
      for (const [start, count, matrix] of drawn_parts(THREE, object, scene, camera, shadow)) {
        ++drawn.ranges;
        for (let i = start; i < start + count; i += 3) {
          const corners = [0, 1, 2].map((k) =>
            new THREE.Vector3().fromBufferAttribute(position, index.getX(i + k)).applyMatrix4(matrix));
          if (matrix.determinant() < 0) corners.reverse();
          drawn.polygons.push(text_of(...corners));
        }
      }
    }
    object.children.forEach(visit);
  };
  visit(scene);
  drawn.polygons.sort();
  return drawn;
}
