// malloc and free of the module: blocks do not overlap, keep their content, and are used again after free.
// usage: heap_test.mjs MODULE.wasm
import { host, require } from "./host.mjs";

const page = await host.load(process.argv[2]);
const { c } = page;

let state = 1;
const random = (below) => {
  state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
  return (state >>> 8) % below;
};
const blocks = [];
const check = ({ at, size, mark }) => {
  const bytes = page.bytes(at, size);
  require(bytes.every((byte) => byte === mark), `the block of ${size} bytes at ${at} was written to`);
};
const round = () => {
  for (let i = 0; i < 3000; ++i) {
    if (blocks.length > 0 && random(100) < 48) {
      const [block] = blocks.splice(random(blocks.length), 1);
      check(block);
      c.free(block.at);
    } else {
      const size = random(10) === 0 ? random(300000) : random(300);
      const block = { at: page.room(size), size, mark: random(256) };
      page.bytes(block.at, size).fill(block.mark);
      blocks.push(block);
    }
  }
  blocks.forEach(check);
  blocks.splice(0).forEach(({ at }) => c.free(at));
};
round();
const grown = c.memory.buffer.byteLength;
// After all blocks are freed, the memory is one block again.
const all = page.room(grown - 1500000);
require(c.memory.buffer.byteLength === grown, "freed blocks were not joined");
c.free(all);
for (let i = 0; i < 5; ++i) round();
require(c.memory.buffer.byteLength < 4 * grown, `memory grew from ${grown} to ${c.memory.buffer.byteLength}`);

// A request that is too large returns 0 and changes nothing.
for (const size of [0xFFFFFFFF, 0xFFFFFFF0, 0x80000000]) require(c.malloc(size) === 0, `malloc(${size})`);
c.free(0);
const nothing = page.room(0);
const something = page.room(1);
require(nothing !== something, "blocks without bytes are blocks");
round();
console.log(`${c.memory.buffer.byteLength / 65536} pages`);
