// Streams a scene that `sightcell pack --stream` has written, into a scene of three.js (0.167 or newer, WebGLRenderer).
// Lengths are in meters, axes are those of glTF: right-handed, +Y up. Words are those of docs/streaming.md.
import type { Camera, Group, Matrix4, Mesh, Object3D } from 'three';

/** "io": the server cannot be reached, or answers with an error; such files are requested again and again.
 * "absent": the server does not have the file (404). "truncated", "checksum": another size or other contents than the
 * front states, twice. "not_ours", "version", "corrupt": no site of `pack --stream`, one of another version, a
 * damaged one. "limit": an image of a type that is not read (KTX2). "disposed": a call after dispose(). */
export type StreamErrorId =
  'io' | 'absent' | 'truncated' | 'checksum' | 'not_ours' | 'version' | 'corrupt' | 'limit' | 'disposed';

export class StreamError extends Error {
  constructor(id: StreamErrorId, url: string, what: string, options?: { cause?: unknown });
  readonly id: StreamErrorId;
  /** The file. */
  readonly url: string;
}

export interface StreamOptions {
  /** The most requests at a time. Default: 8, two more than a browser sends over HTTP/1.1 at once; 24 over HTTP/2 and
   * 3, where the browser states the protocol (for another origin, with Timing-Allow-Origin). */
  requests?: number;
  /** Bytes of polygons and images, before files that no cell needs are removed, those first that were needed least
   * recently. The files of the cell can exceed it. Default: 256 MiB. */
  memory?: number;
  /** Seconds of movement ahead for which files are loaded, after those of the cell. 0: none. Default: 2. */
  lookahead?: number;
  /** Workers that decode pages. 0: the thread of the page. All streams of a page share them. A
   * Content-Security-Policy has to allow them (`worker-src blob:`). Default: 1. */
  workers?: number;
  /** Passed to fetch, for example with `credentials`. */
  init?: RequestInit;
  /** Receives files that cannot be loaded or read; the rest of the scene is drawn. After "absent", "truncated",
   * "checksum", "corrupt" and "limit", the file is given up. Default: console.warn. */
  onError?: (error: StreamError) => void;
  /** Called after a file has arrived or the cell has changed, once stream() has returned. */
  onChange?: () => void;
  /** Called for each mesh before it is added, for example to set castShadow. Materials are shared. */
  onMesh?: (mesh: Mesh) => void;
}

/** A draw: an instance of a primitive of the glTF scene. */
export interface StreamedDraw {
  readonly node: number;
  readonly mesh: number;
  readonly primitive: number;
  readonly instance: number;
  /** 1: the host moves it; 2: in every cell; 4: in no cell, and not drawn here. */
  readonly flags: number;
  /** To the space of the scene. Change it with moveDraw only. */
  readonly matrix: Matrix4;
}

export interface Stream {
  /** Takes the camera's position and direction. Call it in each frame, before the scene is drawn. Does nothing where
   * the camera has not moved. Fails with "disposed". */
  update(camera: Camera): void;
  /** What is drawn. It was added to the scene, and may be moved in it. */
  readonly group: Group;
  readonly draws: readonly StreamedDraw[];
  /** Moves a draw that has flag 1. draw: its index in `draws`. */
  moveDraw(draw: number, matrix: Matrix4): void;
  /** The number of the camera's cell in the .pvs file, or the one it was in last; -1 before one is known. Until a cell
   * has all its files, what the last complete one needs is drawn, too. */
  readonly cell: number;
  /** The camera is in no cell. */
  readonly outside: boolean;
  /** The cell has its pages and a version of each image, but for those that were given up. */
  readonly complete: boolean;
  /** The part of the cell's weight whose pages are there, 0 to 1. */
  readonly progress: number;
  /** Meters up to which nothing is missing: the distance from the camera to the nearest box around a page that is
   * still to come. Infinity where none is, 0 before a cell is known. Fog that ends there covers what has not arrived.
   * Computed when it is read, from the boxes of the cell's pages. */
  readonly clearDistance: number;
  /** The weight of the cell's pages in steradians. */
  readonly weight: number;
  /** Pages of the cell that were given up. */
  readonly failed: number;
  /** Bytes of polygons and images, with estimates for files that are being loaded. */
  readonly memoryBytes: number;
  /** Removes everything from the scene and ends all requests. A second call does nothing. */
  dispose(): void;
}

/** Loads the front of a site, adds a group to the scene, and begins to load what the camera's cell needs. Pages are
 * drawn with the materials that GLTFLoader makes of the front; polygons whose images have not arrived are not drawn.
 * url: the folder that `sightcell pack --stream` has written. Needs a secure context (https or localhost).
 * Fails with "io", "absent", "not_ours", "version", "truncated" and "corrupt" where the front cannot be read. */
export function stream(url: string | URL, scene: Object3D, camera: Camera, options?: StreamOptions): Promise<Stream>;
