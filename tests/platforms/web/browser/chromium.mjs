// Chromium of this machine, without a screen and with software rendering, driven by playwright-core.
import { existsSync } from "node:fs";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

import { require } from "../host.mjs";

const program = "/usr/bin/chromium";
const skip_code = 77;  // ctest reports the test as skipped
const args = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"];

/** Runs use(browser), or ends this program as skipped where Chromium is missing. modules: has playwright-core */
export async function with_chromium(modules, use) {
  if (!existsSync(program)) {
    console.log(`skipped: no ${program} (scripts/bootstrap --tests)`);
    process.exit(skip_code);
  }
  const entry = join(resolve(modules), "playwright-core", "index.mjs");
  const { chromium } = await import(pathToFileURL(entry).href);
  const browser = await chromium.launch({ executablePath: program, args });
  try {
    return await use(browser);
  } finally {
    await browser.close();
  }
}

/** A page on which each console message of a warning or error, each exception and each failed request is a failure. */
export async function open_page(browser, url, options, prepare = async () => {}) {
  const context = await browser.newContext(options);
  const page = await context.newPage();
  const problems = [];
  page.on("console", (message) => {
    if (["warning", "error"].includes(message.type())) problems.push(`console.${message.type()}: ${message.text()}`);
  });
  page.on("pageerror", (error) => problems.push(error.stack));
  page.on("requestfailed", (request) => {
    const { errorText } = request.failure();
    if (errorText === "net::ERR_ABORTED") return;  // by the page itself
    problems.push(`${request.url()}: ${errorText}`);
  });
  await prepare(page);
  await page.goto(url);
  return {
    page,
    no_problems: () => require(problems.length === 0, problems.join("\n")),
    close: () => context.close(),
  };
}
