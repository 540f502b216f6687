// Lines over the picture of three.js: the boxes of cells, and the camera of a set that is frozen.
import type { Camera, LineSegments, Object3D } from 'three';
import type { Frame } from './sightcell.js';
import type { Attachment } from './three.js';

export class DebugOverlay {
  /** scene: the one that was attached; the lines are added to it.
   * kinds: values of DebugLines, combined. Default: the box of the cell (yellow), the same box grown by the margin
   * (orange), and the cells around it (gray). Volumes are blue; parts where the error bound does not hold are red. */
  constructor(pvs: Attachment, scene: Object3D, options?: { kinds?: number });
  /** Call it in each frame instead of Attachment.update, which it calls. */
  update(camera: Camera): Frame;
  /** While true, update() does not move the view: the set stays, and the page can look at it from elsewhere. A green
   * pyramid shows the camera at the first update after the change. */
  frozen: boolean;
  kinds: number;
  /** Whether the lines are drawn. Lines are made only while they are. */
  visible: boolean;
  readonly lines: LineSegments;
  /** Removes the lines. The attachment stays. */
  dispose(): void;
}
