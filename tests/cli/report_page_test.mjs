// A report in Chromium: on a phone, a desktop and paper, light and dark, it has no error, no overflow, no request, and
// text that people can read.
// usage: report_page_test.mjs REPORT.html NODE_MODULES [FOLDER]    FOLDER: receives a picture of each
import { mkdirSync } from "node:fs";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

import { open_page, with_chromium } from "../platforms/web/browser/chromium.mjs";
import { require } from "../platforms/web/host.mjs";

const [report, modules, folder] = process.argv.slice(2);
const least_contrast = 4.5;
const cases = ["light", "dark"].flatMap((colorScheme) => [
  { name: `phone-${colorScheme}`, media: "screen", width: 390, height: 844, colorScheme },
  { name: `desktop-${colorScheme}`, media: "screen", width: 1280, height: 800, colorScheme },
  { name: `paper-${colorScheme}`, media: "print", width: 718, height: 1000, colorScheme },  // A4 without margins of 1 cm
]);

/** Runs in the page: what is wrong with it, as texts, and how many texts were looked at. */
function check_page(least) {
  const problems = [];
  const root = document.documentElement;
  if (root.scrollWidth > root.clientWidth) problems.push(`${root.scrollWidth} px wide in ${root.clientWidth}`);
  for (const image of document.images) if (image.naturalWidth === 0) problems.push(`no picture: ${image.alt}`);
  const channels = (text) => {
    const numbers = text.match(/[\d.]+/g).map(Number);
    return [...numbers.slice(0, 3), numbers[3] ?? 1];
  };
  const luminance = ([red, green, blue]) => [red, green, blue].reduce((sum, value, i) => {
    const share = value / 255;
    return sum + [0.2126, 0.7152, 0.0722][i] * (share <= 0.04045 ? share / 12.92 : ((share + 0.055) / 1.055) ** 2.4);
  }, 0);
  const background_of = (element) => {
    for (let at = element; at !== null; at = at.parentElement) {
      const color = channels(getComputedStyle(at).backgroundColor);
      if (color[3] === 1) return color;
      if (color[3] > 0) problems.push(`a translucent background: ${at.className}`);
    }
    return [255, 255, 255, 1];
  };
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  let texts = 0;
  for (let node = walker.nextNode(); node !== null; node = walker.nextNode()) {
    const element = node.parentElement;
    if (node.data.trim() === "" || element.closest("title, style")) continue;
    ++texts;
    const style = getComputedStyle(element);
    const color = channels(element instanceof SVGElement ? style.fill : style.color);
    const [low, high] = [luminance(color), luminance(background_of(element))].sort((a, b) => a - b);
    const contrast = (high + 0.05) / (low + 0.05);
    if (contrast < least || color[3] < 1) problems.push(`contrast ${contrast.toFixed(2)}: ${node.data.trim()}`);
    const range = document.createRange();
    range.selectNodeContents(node);
    const box = range.getBoundingClientRect();
    if (box.left < -0.5 || box.right > root.clientWidth + 0.5) problems.push(`out of the page: ${node.data.trim()}`);
    const scale = element instanceof SVGElement ? element.getScreenCTM().a : 1;
    const pixels = scale * parseFloat(style.fontSize);
    if (pixels < 9.5) problems.push(`text of ${pixels.toFixed(1)} px: ${node.data.trim()}`);
  }
  return { problems, texts };
}

await with_chromium(modules, async (browser) => {
  for (const { name, media, width, height, colorScheme } of cases) {
    const asked = [];
    const url = pathToFileURL(resolve(report)).href;
    const { page, no_problems, close } = await open_page(browser, url, { viewport: { width, height }, colorScheme },
      async (fresh) => {
        await fresh.emulateMedia({ media, colorScheme });
        fresh.on("request", (request) => asked.push(request.url()));
      });
    const { problems, texts } = await page.evaluate(check_page, least_contrast);
    require(problems.length === 0, `${name}: ${problems.slice(0, 10).join("\n")}`);
    require(texts > 100, `${name}: only ${texts} texts`);
    const others = asked.filter((each) => each !== url && !each.startsWith("data:"));
    require(others.length === 0, `${name} asks for ${others}`);
    no_problems();
    if (folder !== undefined) {
      mkdirSync(folder, { recursive: true });
      await page.screenshot({ path: join(folder, `${name}.png`), fullPage: true });
    }
    await close();
  }
});
console.log(`${cases.length} pages are fine`);
