// Shows of a scene of three.js what is in the set of the camera's cell. See three.d.ts.
import { LoaderUtils, Matrix4, Vector3 } from 'three';

import { SightcellError } from './error.js';
import { PackedBatch } from './three_packed.js';
import { RangesBatch } from './three_ranges.js';

const modes = ['objects', 'ranges', 'packed'];
const attachedScenes = new WeakSet();
const triangleCount = (geometry) => (geometry.index ?? geometry.attributes.position).count / 3;
const instanceCount = (mesh) => (mesh.isInstancedMesh ? mesh.count : 1);
const instancedAttributes = (mesh) => Object.values(mesh.geometry.attributes).filter((a) => a.isInstancedBufferAttribute);

/** What the glTF file states about its nodes: names, marks that a node inherits, and which an animation moves. */
class Nodes {
  constructor(json) {
    this.nodes = json.nodes ?? [];
    this.parents = [];
    this.nodes.forEach((node, i) => node.children?.forEach((child) => { this.parents[child] = i; }));
    this.animated = new Set();
    for (const { target } of (json.animations ?? []).flatMap((animation) => animation.channels)) {
      const pointer = target.extensions?.KHR_animation_pointer?.pointer.match(/^\/nodes\/(\d+)/);
      this.animated.add(pointer ? Number(pointer[1]) : target.node);
    }
  }

  name(node) { return this.nodes[node]?.name ?? `node ${node}`; }

  mark(node, key) {
    for (let at = node; at !== undefined; at = this.parents[at]) {
      const value = this.nodes[at]?.extras?.sightcell?.[key];
      if (value !== undefined) return value;
    }
    return undefined;
  }

  moves(node) {
    for (let at = node; at !== undefined; at = this.parents[at]) if (this.animated.has(at)) return true;
    return false;
  }
}

/** The meshes of each node of the glTF file, in the order of its primitives. What GLTFLoader associates with objects lacks
 * instanced meshes, is lost in clones of a scene, and before release 179 wrong for nodes that share a mesh. So this relies
 * on the order of children: those that the node's own mesh, camera and lights are made of, then the nodes below it. */
function meshesOfNodes({ scene, scenes = [], parser: { json } }) {
  const found = new Map();
  const collect = (object, children, list) => {
    if (object.isMesh || object.isLine || object.isPoints) list.push(object);
    for (const child of object.children.slice(0, children)) collect(child, child.children.length, list);
    return list;
  };
  const walk = (object, node) => {
    const { children = [] } = json.nodes[node];
    const own = Math.max(0, object.children.length - children.length);
    found.set(node, collect(object, own, []));
    walkAll(object.children.slice(own), children);
  };
  const walkAll = (objects, nodes) => objects.slice(0, nodes.length).forEach((object, i) => walk(object, nodes[i]));
  const number = scenes.indexOf(scene);  // -1 for a clone
  walkAll(scene.children, json.scenes[number < 0 ? json.scene ?? 0 : number].nodes ?? []);
  return found;
}

/** The mesh of each draw. Throws where file and scene differ. */
function meshesOfDraws(gltf, draws, nodes) {
  const meshes = meshesOfNodes(gltf);
  const problems = [];
  const drawn = new Map();
  const result = draws.map((draw) => {
    const mesh = meshes.get(draw.node)?.[draw.primitive];
    const found = mesh?.isMesh && draw.instance < instanceCount(mesh) ? triangleCount(mesh.geometry) : 0;
    if (found !== draw.polygonCount) {
      problems.push(`"${nodes.name(draw.node)}" has ${draw.polygonCount} polygons in primitive ${draw.primitive} ` +
        `(instance ${draw.instance}) of the file and ${found} in the scene`);
    }
    drawn.set(mesh, (drawn.get(mesh) ?? 0) + 1);
    return mesh;
  });
  for (const [node, list] of meshes) {
    list.forEach((mesh, primitive) => {
      const missing = mesh.isMesh && triangleCount(mesh.geometry) > 0 ? instanceCount(mesh) - (drawn.get(mesh) ?? 0) : 0;
      if (missing > 0) problems.push(`"${nodes.name(node)}" has ${missing} draws of primitive ${primitive} that the file lacks`);
    });
  }
  if (problems.length > 0) {
    const more = problems.length > 5 ? `, and ${problems.length - 5} more` : '';
    throw new SightcellError('other_scene', `sightcell: the .pvs file is of another scene, or the scene was changed ` +
      `after the bake: ${problems.slice(0, 5).join('; ')}${more}`);
  }
  return result;
}

/** A mesh that is shown or not as a whole, or by instances. */
class WholeMesh {
  constructor(mesh) {
    this.mesh = mesh;
    this.draws = [];  // by instance
    this.before = { visible: mesh.visible, mask: mesh.layers.mask, count: mesh.count };
    if (!mesh.isInstancedMesh) return;
    mesh.computeBoundingSphere();  // of all instances, as three.js computes it only once
    this.attributes = [mesh.instanceMatrix, mesh.instanceColor, ...instancedAttributes(mesh)].filter((a) => a)
      .map((attribute) => ({ attribute, all: attribute.array.slice() }));
  }

  show(shown) {
    // Other nodes can be below a mesh, and `visible` would remove them with it.
    if (this.mesh.children.length === 0) this.mesh.visible = shown && this.before.visible;
    else this.mesh.layers.mask = shown ? this.before.mask : 0;
  }

  /** Moves the visible instances to the front. */
  apply(objects) {
    if (!this.mesh.isInstancedMesh) {
      this.show(objects[this.draws[0]] === 1);
      return;
    }
    let count = 0;
    this.draws.forEach((draw, instance) => {
      if (objects[draw] !== 1) return;
      for (const { attribute: { array, itemSize }, all } of this.attributes) {
        array.set(all.subarray(instance * itemSize, (instance + 1) * itemSize), count * itemSize);
      }
      ++count;
    });
    for (const { attribute } of this.attributes) attribute.needsUpdate = true;
    this.mesh.count = count;
    this.show(count > 0);
  }

  restore() {
    const { visible, mask, count } = this.before;
    this.mesh.visible = visible;
    this.mesh.layers.mask = mask;
    if (!this.mesh.isInstancedMesh) return;
    this.mesh.count = count;
    for (const { attribute, all } of this.attributes) {
      attribute.array.set(all);
      attribute.needsUpdate = true;
    }
  }
}

/** Whether a mesh can be drawn in a batch. Three.js sorts transparent meshes among each other, and turns the front faces of
 * mirrored ones, if they are meshes of their own. */
function fitsBatch(mesh, matrix) {
  const { material, geometry } = mesh;
  return !Array.isArray(material) && !material.transparent && !(material.transmission > 0) && mesh.visible &&
    mesh.isSkinnedMesh !== true && Object.keys(geometry.morphAttributes).length === 0 && matrix.determinant() > 0 &&
    !mesh.instanceColor && instancedAttributes(mesh).length === 0;
}

function batchKey({ material, geometry, castShadow, receiveShadow, renderOrder, layers }) {
  const attributes = Object.entries(geometry.attributes).map(([name, { array, itemSize, normalized }]) =>
    `${name} ${array.constructor.name} ${itemSize} ${normalized}`).sort();
  return [material.uuid, castShadow, receiveShadow, renderOrder, layers.mask, ...attributes].join();
}

class Attachment {
  #scene;
  #whole = new Map();  // mesh -> WholeMesh
  #batches = [];
  #batched;  // the meshes that batches draw
  #batchOfDraw = [];
  #warn;
  #warned = 0;
  #eyes = [];
  #ahead = { eye: new Vector3(), velocity: new Vector3(), time: 0 };

  constructor(gltf, db, { mode = 'objects', skip = () => false, warn = (text) => console.warn(text) }) {
    if (!modes.includes(mode)) throw new SightcellError('argument', `sightcell: there is no mode "${mode}"`);
    if (mode !== 'objects' && db.info.layout === 'merged') {
      throw new SightcellError('argument', `sightcell: mode "${mode}" needs a file that was baked without --layout merged`);
    }
    // What the first one hides would be what the second one restores.
    if (attachedScenes.has(gltf.scene)) throw new SightcellError('argument', 'sightcell: the scene is attached; dispose() first');
    this.#scene = gltf.scene;
    this.#warn = warn;
    const nodes = new Nodes(gltf.parser.json);
    const meshes = meshesOfDraws(gltf, db.draws, nodes);
    const managed = db.draws.map((draw, i) => meshes[i] !== undefined && nodes.mark(draw.node, 'dynamic') !== true &&
      nodes.mark(draw.node, 'never') !== true && !skip(meshes[i], draw));
    gltf.scene.updateWorldMatrix(true, true);
    const batched = mode === 'objects' ? new Set() : this.#makeBatches(db, nodes, meshes, managed, mode);
    db.draws.forEach((draw, i) => {
      const mesh = meshes[i];
      if (!managed[i]) return;
      if (!this.#whole.has(mesh)) this.#whole.set(mesh, new WholeMesh(mesh));
      this.#whole.get(mesh).draws[draw.instance] = i;
    });
    for (const mesh of batched) this.#whole.get(mesh).show(false);  // a raycaster still meets it
    this.#batched = batched;
    this.view = db.createView();
    attachedScenes.add(gltf.scene);
  }

  #makeBatches(db, nodes, meshes, managed, mode) {
    const order = db.order();
    const toScene = new Matrix4().copy(this.#scene.matrixWorld).invert();
    const matrixOf = (mesh, instance) => {
      const matrix = new Matrix4().multiplyMatrices(toScene, mesh.matrixWorld);
      return mesh.isInstancedMesh ? matrix.multiply(new Matrix4().fromArray(mesh.instanceMatrix.array, 16 * instance)) : matrix;
    };
    const matrices = db.draws.map((draw, i) => (managed[i] ? matrixOf(meshes[i], draw.instance) : null));
    const apart = new Set();  // all instances of a mesh are in a batch, or none
    db.draws.forEach((draw, i) => {
      if (!managed[i] || nodes.moves(draw.node) || !fitsBatch(meshes[i], matrices[i])) apart.add(meshes[i]);
    });
    const batches = new Map();
    db.draws.forEach((draw, i) => {
      const mesh = meshes[i];
      if (apart.has(mesh) || draw.polygonCount === 0) return;
      const key = batchKey(mesh);
      if (!batches.has(key)) batches.set(key, mode === 'packed' ? new PackedBatch(mesh) : new RangesBatch(mesh));
      const triangles = order.slice(draw.firstStored, draw.firstStored + draw.polygonCount).map((id) => id - draw.firstSource);
      batches.get(key).add(i, mesh, matrices[i], triangles);
      this.#batchOfDraw[i] = batches.get(key);
    });
    this.#batches = Array.from(batches.values());
    for (const batch of this.#batches) {
      batch.build(db.info.rangeBound);
      const { mesh, like } = batch;
      mesh.name = like.material.name;
      for (const key of ['castShadow', 'receiveShadow', 'renderOrder']) mesh[key] = like[key];
      mesh.layers.mask = like.layers.mask;
      this.#scene.add(mesh);
    }
    return new Set(meshes.filter((mesh) => mesh !== undefined && !apart.has(mesh)));
  }

  update(camera) {
    this.#scene.updateWorldMatrix(true, false);
    const cameras = camera.isArrayCamera && camera.cameras.length > 0 ? camera.cameras : [camera];
    cameras.forEach((each, i) => {
      this.#eyes[i] ??= new Vector3();
      // The cameras of a headset have no parents, and three.js writes their matrices itself.
      if (cameras.length === 1) each.updateWorldMatrix(true, false);
      this.#scene.worldToLocal(this.#eyes[i].setFromMatrixPosition(each.matrixWorld));
    });
    const [first] = this.#eyes;
    let frame;
    if (cameras.length === 1) {
      frame = this.view.move(first);
    } else {
      const min = first.clone(), max = first.clone();
      for (const eye of this.#eyes.slice(0, cameras.length)) {
        min.min(eye);
        max.max(eye);
      }
      frame = this.view.moveBox({ min, max });
    }
    if (frame.changed) this.#apply();
    if (this.view.database.paged) this.#prefetch(first);
    this.#checkNear(cameras[0]);
    return frame;
  }

  /** Downloads what is needed within 3 seconds at this velocity. A jump is none. */
  #prefetch(eye) {
    const { eye: before, velocity, time } = this.#ahead;
    const now = performance.now();
    const seconds = (now - time) / 1000;
    if (seconds < 0.25) return;
    velocity.subVectors(eye, before).divideScalar(seconds);
    if (time === 0 || velocity.length() > 50) velocity.setScalar(0);
    this.view.database.prefetch(eye, velocity, 3);
    before.copy(eye);
    this.#ahead.time = now;
  }

  #apply() {
    const objects = this.view.objects();
    for (const whole of this.#whole.values()) if (!this.#batched.has(whole.mesh)) whole.apply(objects);
    if (this.#batches.length === 0) return;
    for (const batch of this.#batches) batch.clear();
    const ranges = this.view.ranges();
    for (let i = 0; i < ranges.length; i += 3) this.#batchOfDraw[ranges[i]]?.push(ranges[i], ranges[i + 1], ranges[i + 2]);
    for (const batch of this.#batches) {
      batch.finish();
      batch.mesh.visible = batch.mesh.castShadow || batch.count > 0;
    }
  }

  #checkNear({ near, projectionMatrix: { elements: [x, , , , , y] }, isPerspectiveCamera }) {
    const { playerRadius } = this.view.database.info;
    if (!(playerRadius > 0) || isPerspectiveCamera !== true) return;
    const corner = near * Math.sqrt(1 + 1 / (x * x) + 1 / (y * y)) / this.#scene.matrixWorld.getMaxScaleOnAxis();
    if (corner <= 1.0001 * playerRadius || corner === this.#warned) return;
    this.#warned = corner;
    this.#warn(`sightcell: the corners of the near plane are ${corner.toPrecision(3)} m from the eye, and valid viewpoints ` +
      `keep ${playerRadius.toPrecision(3)} m from surfaces. Set camera.near to ` +
      `${(near * playerRadius / corner).toPrecision(3)} or less, or bake with a larger --player-radius.`);
  }

  get batches() { return this.#batches.map(({ mesh }) => mesh); }

  dispose() {
    for (const whole of this.#whole.values()) whole.restore();
    for (const batch of this.#batches) batch.dispose();
    this.#whole.clear();
    this.#batches = [];
    this.view.dispose();
    attachedScenes.delete(this.#scene);
  }
}

export async function embeddedPvs({ parser }) {
  const pvs = parser.json.extras?.sightcell?.pvs;
  if (pvs?.bufferView !== undefined) return parser.getDependency('bufferView', pvs.bufferView);
  if (pvs?.uri === undefined) return null;
  return parser.fileLoader.loadAsync(LoaderUtils.resolveURL(pvs.uri, parser.options.path));
}

export async function attach(gltf, db, options = {}) {
  return new Attachment(gltf, db, options);
}
