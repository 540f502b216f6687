// Prints the same text of a file as decode_dump.cpp, through the package.
import { nine_digits } from "../dump.mjs";
import { fnv_hash } from "../host.mjs";

const unsigned = (number) => number >>> 0;  // -1 is 0xFFFFFFFF in C
const hash_of = (numbers) => {
  const hash = new fnv_hash();
  for (const number of numbers) hash.add(number);
  return hash.hex();
};

function facts_of(db) {
  const { info } = db;
  const layout = ["instanced", "merged"].indexOf(info.layout);
  return `version ${info.formatVersion}\nfingerprint ${info.sceneFingerprint}\npolygons ${info.polygonCount}\n` +
    `margin ${nine_digits(info.margin)}\nmax_pixel_error ${nine_digits(info.maxPixelError)}\n` +
    `confidence ${nine_digits(info.confidence)}\nlayout ${layout} cells ${info.cellCount} draws ${info.drawCount} ` +
    `range_bound ${info.rangeBound}\n`;
}

function draws_of(db) {
  return db.draws.map((d, i) => `draw ${i}: ${[d.node, d.mesh, d.primitive, d.instance, unsigned(d.material), d.group,
    d.firstSource, d.polygonCount, d.firstStored, d.baseVertex, d.hostTag].join(" ")}\n`).join("");
}

// Each byte of a name becomes one character, regardless of UTF-8.
function named_groups_of(db) {
  let text = "";
  db.namedGroups().forEach((name, i) => { text += `named group ${i}: ${Buffer.from(name, "utf8").toString("latin1")}\n`; });
  db.namedGroupsOfDraws().forEach((group, draw) => {
    if (group !== -1) text += `named group of draw ${draw}: ${group}\n`;
  });
  return text;
}

function cells_of(db) {
  const view = db.createView();
  const stored = Uint32Array.from({ length: 3 * db.info.polygonCount }, (_, i) => Math.imul(i, 2654435761));
  const list = new Uint32Array(stored.length);
  let text = "";
  for (let cell = 0; cell < db.info.cellCount; ++cell) {
    const { min, max } = db.cellBox(cell);
    text += `cell ${cell}: ${min.map(nine_digits).join(" ")}  ${max.map(nine_digits).join(" ")}  sees`;
    const [x, y, z] = min.map((end, axis) => Math.fround(0.5 * end) + Math.fround(0.5 * max[axis]));
    view.move([1e6, 1e6, 1e6]);  // outside all cells, so that the view does not keep the previous cell
    const frame = view.move({ x, y, z });
    if (frame.cell !== cell || frame.drawAll) text += ` from cell ${frame.cell} flags ${frame.flags}`;
    for (const polygon of view.polygons().sort()) text += ` ${polygon}`;
    text += `\nranges ${cell}:${Array.from(view.ranges(), (number) => ` ${number}`).join("")}\n`;
    const length = view.indices(stored, list);
    text += `indices ${cell}: ${hash_of(list.subarray(0, length))}\n`;
  }
  view.dispose();
  return text;
}

// Nothing for a file without viewpoints.
function viewpoints_of(db) {
  if (!(db.info.playerRadius > 0)) return "";
  let text = `player_radius ${nine_digits(db.info.playerRadius)}\n`;
  for (let cell = 0; cell < db.info.cellCount; ++cell) {
    const { validShare, outsideShare } = db.cellViewpoints(cell);
    text += `viewpoints ${cell}: ${nine_digits(validShare)} ${nine_digits(outsideShare)}\n`;
  }
  return text;
}

export function dump(db) {
  return facts_of(db) + draws_of(db) + named_groups_of(db) + `order ${hash_of(db.order())}\n` + cells_of(db) +
    viewpoints_of(db);
}
