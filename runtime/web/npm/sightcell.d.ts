// The interface of the package. Lengths are in meters, axes are those of glTF: right-handed, +Y up. Words such as cell,
// draw, range and stored order are those of sightcell.h and of the glossary.
//
// Errors are instances of SightcellError. Objects with dispose() hold memory of the WebAssembly module, which JavaScript
// does not collect: call dispose() when you drop one. A second call does nothing, and any other use throws "disposed".

/** Three numbers, or an object with x, y and z, such as a Vector3 of three.js. */
export type Point = ArrayLike<number> | { readonly x: number; readonly y: number; readonly z: number };

/** Two corners that belong to the box, min <= max on each axis. A Box3 of three.js is one. */
export interface Box {
  readonly min: Point;
  readonly max: Point;
}

/** The name of a status of sightcell.h in lower case, or "disposed". */
export type SightcellErrorId =
  | 'argument' | 'memory' | 'capacity' | 'stale' | 'absent' | 'io' | 'not_ours' | 'version' | 'truncated' | 'checksum'
  | 'corrupt' | 'limit' | 'other_scene' | 'disposed';

export class SightcellError extends Error {
  constructor(id: SightcellErrorId, message: string, options?: { cause?: unknown });
  readonly id: SightcellErrorId;
}

export interface LoadOptions {
  /** Where the module is, or its bytes, or the compiled module. Default: sightcell.wasm beside this package's files. */
  wasm?: string | URL | ArrayBuffer | ArrayBufferView | WebAssembly.Module;
}

/** The WebAssembly module. One is enough for a page. */
export class Sightcell {
  private constructor();
  /** Fails with "io" and "version". */
  static load(options?: LoadOptions): Promise<Sightcell>;

  /** Opens a .pvs file, or the one in a .glb, of which the module keeps a copy.
   * Fails with "absent" for a .glb without one, and with "memory", "not_ours", "version", "truncated", "checksum", "corrupt" and "limit". */
  open(bytes: ArrayBuffer | SharedArrayBuffer | ArrayBufferView): Database;

  /** Opens a .pvs file of a server. Downloads its first bytes, the rest of its tables, and then, while views move, the
   * sets that they need, in pages of up to 64 cells (HTTP requests of byte ranges). A small file, and one of a server
   * that ignores ranges, arrives whole. In node, a file: URL is read from the disk.
   * options: passed to fetch, but for the members of OpenOptions. A signal is for opening only.
   * Fails with "io" and as open(). */
  openUrl(url: string | URL, options?: OpenOptions): Promise<Database>;

  /** Closes all files and drops the module. */
  dispose(): void;
  readonly disposed: boolean;

  /** The size of the module's memory, which grows and never shrinks. */
  readonly memoryBytes: number;
}

export interface OpenOptions extends RequestInit {
  /** true: downloads the whole file. Default: false. */
  whole?: boolean;
  /** Bytes of the first request. A file that is no larger arrives whole. Default: 65,536. */
  firstBytes?: number;
  /** The most bytes of pages in memory; the least recently used are removed. A file with a larger page arrives whole.
   * Default: 16 MiB. */
  residentBytes?: number;
  /** Called when a page has arrived: the next move of a view may change. For hosts that draw on demand. */
  pageLoaded?: () => void;
  /** Called when a page has not arrived ("io") or is damaged ("checksum"). The module downloads it again after 1 second,
   * then after 2, and so on up to 30, except for a damaged one, whose cells stay `damaged`. Default: console.warn. */
  pageFailed?: (error: SightcellError) => void;
}

/** Facts about a file. */
export interface Info {
  readonly formatVersion: number;
  readonly layout: 'instanced' | 'merged';
  readonly polygonCount: number;
  readonly cellCount: number;
  readonly drawCount: number;
  /** The most ranges that View.ranges returns for this file. */
  readonly rangeBound: number;
  /** The set of a cell holds for its box grown by this on all sides. */
  readonly margin: number;
  /** The largest upper bound of any cell of the miss probability, or of the bake's --metric: 0 .. 1. */
  readonly maxPixelError: number;
  /** With which that bound holds, 0 .. 1. */
  readonly confidence: number;
  /** 32 hexadecimal digits, as `sightcell info` prints them. */
  readonly sceneFingerprint: string;
  /** What valid viewpoints keep from surfaces; 0 if the file does not state it. */
  readonly playerRadius: number;
  readonly volumeCount: number;
}

/** An entry of the draw table. The table is NOT in the order of the scene: find your object by node, primitive and
 * instance. */
export interface Draw {
  /** Index in the glTF file, as are mesh and material. */
  readonly node: number;
  readonly mesh: number;
  /** Index in the mesh. */
  readonly primitive: number;
  /** Index in EXT_mesh_gpu_instancing, else 0. */
  readonly instance: number;
  /** -1 for the default material. */
  readonly material: number;
  /** The draw group of a merged file, else 0. */
  readonly group: number;
  /** Source id of its first polygon; the ids of a draw are consecutive. */
  readonly firstSource: number;
  readonly polygonCount: number;
  /** Stored number of the first polygon of the draw, or of its draw group. */
  readonly firstStored: number;
  /** Vertices of all draws before this one in source order. */
  readonly baseVertex: number;
  /** The value that the host gave the draw when it baked its own arrays, else 0. */
  readonly hostTag: bigint;
}

/** Counts. A chunk is the sets of up to 64 cells; members after memoryBytes are 0 for a file that arrived whole. */
export interface DatabaseStatistics {
  readonly chunkCount: number;
  readonly memoryBytes: bigint;
  readonly residentBytes: bigint;
  readonly requests: bigint;
  readonly deliveredBytes: bigint;
  readonly evictions: bigint;
  readonly refusedDeliveries: bigint;
}

/** An open .pvs file. */
export class Database {
  private constructor();
  readonly info: Info;
  /** The draw table. */
  readonly draws: readonly Draw[];
  /** The stored number from which the ranges of each draw count, or of each draw group of a merged file. */
  readonly firstStored: readonly number[];

  /** The source id of each stored polygon. Permute the index buffer of each primitive by it once after loading: triangle
   * i of a draw becomes triangle order[firstStored + i] - firstSource of its primitive. */
  order(): Uint32Array;
  /** The box of a cell, without the margin. */
  cellBox(cell: number): { min: number[]; max: number[] };
  /** validShare: the estimated share of the region of the cell that is valid viewpoints. outsideShare: the upper limit
   * of the share of the cell's valid viewpoints that are outside the region, where the error bound does not hold. */
  cellViewpoints(cell: number): { validShare: number; outsideShare: number };
  volumeBox(volume: number): { min: number[]; max: number[] };
  namedGroups(): string[];
  /** The number of the named group of each draw, or -1. */
  namedGroupsOfDraws(): Int32Array;

  /** A camera. */
  createView(): View;

  /** True if pages arrive while views move. Until the page of a cell is there, frames in the cell are `pending` and
   * `drawAll`. check() then fails with "io" and View.importance() with "absent": use the option `whole` for these. */
  readonly paged: boolean;
  /** Downloads the pages that a moving camera may need soon, the nearest first, up to 32 in a call. Does nothing for a
   * file that arrived whole. velocity: in meters per second. seconds: the time ahead. */
  prefetch(position: Point, velocity: Point, seconds: number): void;

  /** Checks the whole file. Throws the first fault: "checksum" or "corrupt". */
  check(): void;
  statistics(): DatabaseStatistics;
  /** Disposes the views of the file, too. */
  dispose(): void;
  readonly disposed: boolean;
}

/** The result of a move. */
export interface Frame {
  /** The view cell that contains the eye, or -1. */
  readonly cell: number;
  /** SIGHTCELL_FRAME_* of sightcell.h; the members below are its bits. */
  readonly flags: number;
  /** Polygons to draw. */
  readonly polygonCount: number;
  readonly revision: number;
  /** The polygons to draw differ from those after the last move: call ranges() or objects() again. */
  readonly changed: boolean;
  /** The visible polygons are not known: outputs return everything. */
  readonly drawAll: boolean;
  /** The eye is in no cell. */
  readonly outside: boolean;
  /** The page of the cell has not arrived. */
  readonly pending: boolean;
  /** The page of the cell is damaged. */
  readonly damaged: boolean;
}

/** Combine by |. */
export const DebugLines: {
  readonly cell: number;
  readonly kept: number;
  readonly neighbors: number;
  readonly volumes: number;
  readonly outsideRegion: number;
};

export interface Lines {
  /** Two corners of three numbers for each line. */
  readonly positions: Float32Array;
  /** One value of DebugLines for each line. */
  readonly kinds: Uint32Array;
  /** The cell or volume of each line. */
  readonly numbers: Uint32Array;
}

export interface ViewStatistics {
  readonly moves: bigint;
  readonly rowsDecoded: bigint;
  readonly changes: bigint;
  readonly movesOutside: bigint;
  readonly movesPending: bigint;
  readonly movesDrawAll: bigint;
  readonly polygons: bigint;
}

/** A camera. Where the visible polygons are not known, outputs return everything.
 *
 * What ranges() and objects() return is valid until the next move that has `changed`; the view then writes into the same
 * arrays. They are not in the memory of the module, so that they keep their elements when it grows. */
export class View {
  private constructor();
  readonly database: Database;
  /** The result of the last move. Each move fills the same object. */
  readonly frame: Frame;

  /** Moves the camera. Fails with "argument" for a NaN: the view then returns everything. */
  move(position: Point): Frame;
  /** Moves the camera to an unknown position in a box: two eyes, or the next frames. */
  moveBox(box: Box): Frame;
  /** The point to which the positions of later calls are relative. */
  setOrigin(origin: Point): void;
  /**
   * The set that later moves outside all cells return, up to a distance from the cell whose set it is. whilePending:
   * the same in a cell whose page is on its way; "last" keeps what was shown. A new view has "all" for both.
   */
  setPolicy(outside: 'all' | 'nearest' | 'last', maxDistance?: number, whilePending?: 'all' | 'last'): void;
  /** Shows or hides a named group, by its name or number, from the next move on. */
  showNamedGroup(group: string | number, shown: boolean): void;

  /** Three numbers for each range: draw (or draw group), first polygon, number of polygons. */
  ranges(): Uint32Array;
  /** For each draw 1 if it has a polygon to draw, else 0. */
  objects(): Uint8Array;
  /** A new array with the source ids of the polygons to draw. */
  polygons(): Uint32Array;
  /** Copies the indices of the polygons to draw, in the order of ranges(), and returns how many there are:
   * 3 * frame.polygonCount. storedIndices: the indices of all polygons in stored order. Fails with "capacity". */
  indices(storedIndices: Uint32Array, target: Uint32Array): number;
  /** A new array with the solid angle in steradians that each draw (or draw group) covers in the view: what to load
   * first. Fails with "absent" for a file without importance, and with "stale" where everything is drawn. */
  importance(): Float32Array;
  /** False if nothing in the box can be visible. Always true for a file without volumes. */
  boxVisible(box: Box): boolean;
  /** Edges of boxes of cells and volumes. kinds: values of DebugLines, combined. */
  debugLines(kinds: number): Lines;
  statistics(): ViewStatistics;
  dispose(): void;
  readonly disposed: boolean;
}
