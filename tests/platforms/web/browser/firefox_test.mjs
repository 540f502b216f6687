// The sample's page in Firefox: with and without the PVS it draws the same pictures, and the browser has nothing to warn of.
// usage: firefox_test.mjs SITE VIEWPOINTS WIDTH    SITE: of samples/web/make_site.py    WIDTH: of the window
import { require } from "../host.mjs";
import { with_firefox } from "./firefox.mjs";
import { serve } from "./static_server.mjs";
import { pictures_are_the_same, tools, wrong_share_at } from "./walk_pictures.mjs";

const [site, viewpoints, width] = process.argv.slice(2);
const size = { width: Number(width), height: Number(width) * 9 / 16 };
const server = await serve(site);
try {
  const text = await with_firefox(server.url, size, async (page) => {
    await page.waitForFunction(() => Boolean(globalThis.walk ?? document.querySelector("#loading.failed")));
    await page.evaluate(() => globalThis.walk.pause());
    await page.evaluate(tools);
    return pictures_are_the_same(page, { count: Number(viewpoints), most_wrong: wrong_share_at(size.width) });
  });
  const missing = server.asked.filter(({ status, path }) => status === 404 && path !== "/favicon.ico");
  require(missing.length === 0, `not in the site: ${missing.map(({ path }) => path)}`);
  require(server.asked.some(({ status }) => status === 206), "no byte range was requested");
  console.log(text);
} finally {
  server.close();
}
