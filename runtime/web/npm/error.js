// What everything of this package throws. `id` is the name of a status of sightcell.h in lower case, such as "not_ours",
// or "disposed".
import { constants } from './layout.js';

const names = new Map();
for (const [name, value] of Object.entries(constants)) {
  if (name.startsWith('ERR_')) names.set(value, name.slice(4).toLowerCase());
}

export class SightcellError extends Error {
  constructor(id, message, options) {
    super(message, options);
    this.name = 'SightcellError';
    this.id = id;
  }

  /** The error of a status; text: what the library writes about it. */
  static ofStatus(status, what, text) {
    return new SightcellError(names.get(status) ?? `status_${status}`, `sightcell: ${what}: ${text}`);
  }
}

export function badArgument(what) {
  return new SightcellError('argument', `sightcell: ${what}`);
}
