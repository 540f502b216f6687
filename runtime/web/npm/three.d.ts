// Draws of a scene of three.js (0.167 or newer) what is in the potentially visible set of the camera's cell.
import type { Camera, Mesh, Object3D } from 'three';
import type { Database, Draw, Frame, View } from './sightcell.js';

/** What GLTFLoader returns. `scene` may be a clone. */
export interface LoadedScene {
  readonly scene: Object3D;
  readonly scenes?: Object3D[];
  readonly parser: { readonly json: any };
}

export interface AttachOptions {
  /** "objects" (the default) shows and hides meshes and instances. "ranges" draws only the visible polygons: a BatchedMesh
   * per material replaces all meshes that are opaque, not animated, not mirrored and without skin, morph targets and
   * attributes of instances. The others are shown and hidden as with "objects". "packed" does the same with one Mesh per
   * material, whose vertices are in the space of the scene and whose index buffer it fills when the cell changes: one draw
   * call each, also without WEBGL_multi_draw. It takes memory for the vertices of all instances, and 24 bytes per polygon. */
  mode?: 'objects' | 'ranges' | 'packed';
  /** Meshes that are left to the page. Nodes with the mark `dynamic` or `never` always are: no set contains them. */
  skip?: (mesh: Mesh, draw: Draw) => boolean;
  /** Receives warnings. Default: console.warn. */
  warn?: (text: string) => void;
}

export interface Attachment {
  /** Call it in each frame, before the scene is drawn. For an ArrayCamera, such as that of a headset, the set holds for
   * all of its cameras. Warns where the near plane does not fit the player radius of the bake. */
  update(camera: Camera): Frame;
  readonly view: View;
  /** The meshes that mode "ranges" (BatchedMesh) or "packed" added to the scene. With WebGLRenderer, they cast shadows of
   * all of their polygons; meshes that are not shown cast none. */
  readonly batches: Mesh[];
  /** Shows everything again, and disposes the view. */
  dispose(): void;
}

/** The bytes of the .pvs file that a scene contains or names (sightcell bake --embed); null if there is none. */
export function embeddedPvs(gltf: { readonly parser: any }): Promise<ArrayBuffer | null>;

/** Finds the mesh of each draw. Call it before you move, add or remove objects of the scene. Positions of nodes count from
 * the scene, which may be anywhere; what is drawn in a batch does not move in it.
 * Fails with "other_scene" where the file and the scene have different polygons; the message names the nodes. Fails with
 * "argument" where the scene has an attachment that is not disposed. */
export function attach(gltf: LoadedScene, db: Database, options?: AttachOptions): Promise<Attachment>;
