// What docs/hosting.md and the README.md of the package show: check_readme.py and install_test.mjs hold the texts against
// what is between the markers. user.mjs runs it.

/* [package */
import { Sightcell } from 'sightcell';

export async function openScene(url, show) {
  const sightcell = await Sightcell.load();
  const db = await sightcell.openUrl(url);
  const view = db.createView();
  return (position) => {  // in each frame
    if (!view.move(position).changed) return;
    const visible = view.objects();  // for each draw 1 or 0
    db.draws.forEach((draw, i) => show(draw.node, draw.primitive, draw.instance, visible[i] === 1));
  };
}
/* package] */
