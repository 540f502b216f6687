// A plugin for 3d-tiles-renderer (0.5): of a site with a tileset (`sightcell pack --stream --tileset`), only the tiles
// that are visible from the camera's cell are loaded and drawn, the most visible first. It takes the cells from the
// front and the cell chunks of the site. Tiles of other tilesets are not changed.
import type { StreamError } from './stream.js';

export interface CellTilesOptions {
  /** Receives a front or cell chunk that cannot be loaded. Where no cell is known because of it, tiles are loaded by
   * distance as without the plugin; else those of the last known cell stay. Default: console.warn. */
  onError?: (error: StreamError) => void;
}

/** What 3d-tiles-renderer calls a tile. */
export interface CellTile {
  readonly extras?: any;
  readonly children?: CellTile[];
}

export class CellTilesPlugin {
  /** url: the folder of the site. Register the plugin with registerPlugin before the first update. The first camera of
   * the renderer is the one whose cell counts. `group` of the renderer may be anywhere, but has the axes of tiles: turn
   * it by -90 degrees about x for Y up. */
  constructor(url: string | URL, options?: CellTilesOptions);
  readonly name: string;
  /** The number of the camera's cell in the .pvs file, or the one it was in last; -1 before one is known. Until one is
   * known, no tile is visible. */
  readonly cell: number;
  /** All tiles of the cell are loaded, or have failed. */
  readonly complete: boolean;
  /** Whether the cell, the last complete cell or every cell needs the page of the tile, or that of a tile below it. */
  visible(tile: CellTile): boolean;
  /** Steradians per byte that the page of the tile covers in the cell, times how much of that is probably in the view,
   * 1/64 to 1. 0: not needed; Infinity: in every cell. */
  priority(tile: CellTile): number;
  /** 3d-tiles-renderer calls these. */
  init(tiles: any): void;
  calculateTileViewError(tile: CellTile, target: { inView: boolean; error: number }): boolean;
  dispose(): void;
}
