// The .pvs file in a .glb that `sightcell bake --embed` has written.
import { SightcellError } from './error.js';

const corrupt = (what) => new SightcellError('corrupt', `sightcell: the .glb is damaged: ${what}. Bake it again.`);

/** The bytes of the .pvs file in a .glb; other bytes as they are. */
export function pvsOfGlb(bytes) {
  const numbers = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  if (bytes.length < 20 || numbers.getUint32(0, true) !== 0x46546c67) return bytes;
  const end = 20 + numbers.getUint32(12, true);
  if (end > bytes.length) throw corrupt('its JSON is cut short');
  let json;
  try {
    json = JSON.parse(new TextDecoder().decode(bytes.slice(20, end)));
  } catch (error) {
    throw corrupt(error.message);
  }
  const number = json?.extras?.sightcell?.pvs?.bufferView;
  if (number === undefined) {
    throw new SightcellError('absent', 'sightcell: the .glb contains no .pvs file. Bake it with --embed.');
  }
  const { buffer, byteOffset = 0, byteLength } = json.bufferViews?.[number] ?? {};
  const size = end + 8 <= bytes.length ? numbers.getUint32(end, true) : 0;
  const whole = [byteOffset, byteLength].every((value) => Number.isInteger(value) && value >= 0);
  if (buffer !== 0 || !whole || byteOffset + byteLength > size || end + 8 + size > bytes.length) {
    throw corrupt(`buffer view ${number}`);
  }
  return bytes.subarray(end + 8 + byteOffset, end + 8 + byteOffset + byteLength);
}
