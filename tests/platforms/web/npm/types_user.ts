// Uses every declaration of sightcell.d.ts. types_test.mjs compiles it.
import { DebugLines, Sightcell, SightcellError } from 'sightcell';
import type { Box, Database, DatabaseStatistics, Draw, Frame, Info, Lines, LoadOptions, OpenOptions, Point, SightcellErrorId, View,
  ViewStatistics } from 'sightcell';

const options: LoadOptions = { wasm: new URL('sightcell.wasm', 'https://example.org/') };
const sightcell: Sightcell = await Sightcell.load(options);
await Sightcell.load();
const pages: OpenOptions = { whole: false, firstBytes: 16384, residentBytes: 2 ** 20, pageLoaded: () => {},
  pageFailed: (error) => console.error(error.id, error.message), headers: { Authorization: 'none' } };
const paged: boolean = (await sightcell.openUrl(new URL('https://example.org/level.pvs'), pages)).paged;
const db: Database = await sightcell.openUrl('level.pvs', { signal: new AbortController().signal });
const fromBytes: Database = sightcell.open(new Uint8Array(10));
sightcell.open(new ArrayBuffer(10));
const memory: [number, boolean] = [sightcell.memoryBytes, sightcell.disposed];

const info: Info = db.info;
const facts: number[] = [info.formatVersion, info.polygonCount, info.cellCount, info.drawCount, info.rangeBound, info.margin,
  info.maxPixelError, info.confidence, info.playerRadius, info.volumeCount];
const texts: string[] = [info.layout, info.sceneFingerprint];
const merged: boolean = info.layout === 'merged';

const draw: Draw = db.draws[0]!;
const numbers: number[] = [draw.node, draw.mesh, draw.primitive, draw.instance, draw.material, draw.group, draw.firstSource,
  draw.polygonCount, draw.firstStored, draw.baseVertex, db.firstStored[0]!];
const tag: bigint = draw.hostTag;
const order: Uint32Array = db.order();
const box: Box = db.cellBox(0);
const corner: number = db.volumeBox(0).min[0]!;
const { validShare, outsideShare }: { validShare: number; outsideShare: number } = db.cellViewpoints(0);
const names: string[] = db.namedGroups();
const groups: Int32Array = db.namedGroupsOfDraws();
db.prefetch([0, 0, 0], { x: 1, y: 0, z: 0 }, 2);
db.check();
const counts: DatabaseStatistics = db.statistics();
const sums: bigint[] = [counts.memoryBytes, counts.residentBytes, counts.requests, counts.deliveredBytes, counts.evictions,
  counts.refusedDeliveries, BigInt(counts.chunkCount)];

const view: View = db.createView();
const vector = { x: 1, y: 2, z: 3, isVector3: true };  // of three.js
const point: Point = vector;
const frame: Frame = view.move(point);
view.move([1, 2, 3]);
view.move(new Float32Array(3));
view.moveBox({ min: vector, max: [2, 3, 4] });
view.setOrigin([1000, 0, 0]);
view.setPolicy('nearest', 2);
view.setPolicy('last');
view.showNamedGroup('door', false);
view.showNamedGroup(0, true);
const flags: boolean[] = [frame.changed, frame.drawAll, frame.outside, frame.pending, frame.damaged,
  view.boxVisible(box), view.disposed, fromBytes.disposed];
const more: number[] = [frame.cell, frame.flags, frame.polygonCount, frame.revision];
const ranges: Uint32Array = view.ranges();
const objects: Uint8Array = view.objects();
const steradians: Float32Array = view.importance();
const length: number = view.indices(view.polygons(), order);
const lines: Lines = view.debugLines(DebugLines.cell | DebugLines.kept | DebugLines.neighbors | DebugLines.volumes |
  DebugLines.outsideRegion);
const arrays: [Float32Array, Uint32Array, Uint32Array] = [lines.positions, lines.kinds, lines.numbers];
const statistics: ViewStatistics = view.statistics();
sums.push(statistics.moves, statistics.rowsDecoded, statistics.changes, statistics.movesOutside, statistics.movesPending,
  statistics.movesDrawAll, statistics.polygons);
const same: boolean = view.database === db && view.frame === frame;

try {
  view.dispose();
  db.dispose();
  sightcell.dispose();
} catch (error) {
  const id: SightcellErrorId = error instanceof SightcellError ? error.id : 'disposed';
  throw new SightcellError(id, 'again', { cause: error });
}

// @ts-expect-error A name is no point.
view.move('door');
// @ts-expect-error The draw table cannot be changed.
db.draws[0] = draw;
// @ts-expect-error There is no such policy.
view.setPolicy('none');
// @ts-expect-error Only load() makes one.
new Sightcell();
// @ts-expect-error A box has two corners.
view.boxVisible({ min: [0, 0, 0] });

export { arrays, corner, facts, flags, groups, length, memory, merged, more, names, numbers, objects, outsideShare, paged, ranges,
  same, steradians, sums, tag, texts, validShare };
