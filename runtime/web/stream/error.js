/** What this package throws and reports. `id` is one of those of the package "sightcell". */
export class StreamError extends Error {
  constructor(id, url, what, options) {
    super(`sightcell: ${url}: ${what}`, options);
    Object.assign(this, { name: 'StreamError', id, url });
  }
}
