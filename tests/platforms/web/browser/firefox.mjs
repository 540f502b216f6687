// Firefox of this machine on a screen of Xvfb, driven by Marionette, its protocol for remote control: messages of JSON
// text over TCP, each after its length. Without a screen, Firefox has no WebGL.
import { spawn } from "node:child_process";
import { existsSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { createServer, connect } from "node:net";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { setTimeout as sleep } from "node:timers/promises";

import { require } from "../host.mjs";

const program = "/usr/bin/firefox-esr";
const skip_code = 77;  // ctest reports the test as skipped
const start_seconds = 120;
// Of three.js: Firefox has no WEBGL_multi_draw, so that it draws range by range; and shadow maps are compared with linear
// filtering.
const known_warnings = ["WEBGL_multi_draw extension not supported", "Depth texture comparison requests"];

async function free_port() {
  const server = createServer();
  await new Promise((done) => server.listen(0, "127.0.0.1", done));
  const { port } = server.address();
  await new Promise((done) => server.close(done));
  return port;
}

async function connected(port, browser) {
  for (let left = 5 * start_seconds; left > 0; --left) {
    require(browser.exitCode === null, `Firefox ended with ${browser.exitCode}`);
    try {
      return await new Promise((done, failed) => {
        const socket = connect(port, "127.0.0.1", () => done(socket));
        socket.on("error", failed);
      });
    } catch {
      await sleep(200);
    }
  }
  throw new Error(`Firefox does not answer after ${start_seconds} s`);
}

/** Commands and their answers. An answer is [1, id, error, result]. */
class Marionette {
  #socket;
  #received = Buffer.alloc(0);
  #waiting = [];
  #messages = [];
  #last_id = 0;

  constructor(socket) {
    this.#socket = socket;
    socket.on("data", (data) => this.#receive(data));
    socket.on("close", () => this.#waiting.splice(0).forEach(({ failed }) => failed(new Error("Firefox ended"))));
    socket.on("error", () => {});  // close follows
  }

  #receive(data) {
    this.#received = Buffer.concat([this.#received, data]);
    for (;;) {
      const colon = this.#received.indexOf(":");
      const end = colon + 1 + Number(this.#received.subarray(0, Math.max(colon, 0)));
      if (colon < 0 || this.#received.length < end) return;
      const message = JSON.parse(this.#received.subarray(colon + 1, end));
      this.#received = this.#received.subarray(end);
      const next = this.#waiting.shift();
      if (next === undefined) this.#messages.push(message);
      else next.done(message);
    }
  }

  next() {
    if (this.#messages.length > 0) return Promise.resolve(this.#messages.shift());
    return new Promise((done, failed) => this.#waiting.push({ done, failed }));
  }

  async run(name, parameters = {}) {
    const text = Buffer.from(JSON.stringify([0, ++this.#last_id, name, parameters]));
    this.#socket.write(`${text.length}:`);
    this.#socket.write(text);
    const [, , error, result] = await this.next();
    if (error !== null) throw new Error(`${name}: ${error.error}: ${error.message}`);
    return result;
  }
}

/** What the tests use of a page of playwright. */
class Page {
  #marionette;

  constructor(marionette) {
    this.#marionette = marionette;
  }

  // The script of a command has globals of its own, so the page evaluates `act`. Values travel as JSON text.
  async evaluate(act, given) {
    const code = `(async () => JSON.stringify(await (${act})(${JSON.stringify(given ?? null)})) ?? "null")()`;
    const script = `const [code, done] = arguments;
      window.eval(code).then((value) => done({ value }), (error) => done({ error: String(error) }));`;
    const { value: answer } = await this.#marionette.run("WebDriver:ExecuteAsyncScript", { script, args: [code] });
    if (answer.error !== undefined) throw new Error(answer.error);
    return JSON.parse(answer.value);
  }

  async waitForFunction(done, given) {
    for (let left = 3000; left > 0; --left) {
      if (await this.evaluate(`async (given) => Boolean(await (${done})(given))`, given)) return;
      await sleep(20);
    }
    throw new Error(`does not become true: ${done}`);
  }
}

/** Opens the page and runs use(page). Each warning or error of the console is a failure. Ends this program as skipped where
    Firefox is missing. */
export async function with_firefox(url, { width, height }, use) {
  if (!existsSync(program)) {
    console.log(`skipped: no ${program} (scripts/bootstrap --tests --firefox)`);
    process.exit(skip_code);
  }
  const profile = mkdtempSync(join(tmpdir(), "firefox_"));
  const port = await free_port();
  const preferences = { "marionette.port": port, "devtools.console.stdout.content": true,
    "datareporting.policy.dataSubmissionEnabled": false, "app.normandy.enabled": false, "app.update.disabledForTesting": true };
  writeFileSync(join(profile, "user.js"),
    Object.entries(preferences).map(([name, value]) => `user_pref("${name}", ${JSON.stringify(value)});\n`).join(""));
  const screen = spawn("Xvfb", ["-displayfd", "1", "-screen", "0", "1600x1000x24", "-nolisten", "tcp"],
    { stdio: ["ignore", "pipe", "ignore"] });
  const display = await new Promise((done, failed) => {
    screen.stdout.once("data", (number) => done(`:${String(number).trim()}`));
    screen.once("exit", () => failed(new Error("Xvfb ended")));
    screen.once("error", failed);
  });
  const browser = spawn(program, ["--marionette", "--no-remote", "--profile", profile],
    { detached: true, env: { ...process.env, DISPLAY: display, HOME: profile, LIBGL_ALWAYS_SOFTWARE: "1" } });
  const problems = [];
  const listen = (text) => {
    for (const line of String(text).split("\n")) {
      const complains = /^console\.(warn|error)|^JavaScript (warning|error)/.test(line);
      if (complains && !known_warnings.some((known) => line.includes(known))) problems.push(line);
    }
  };
  browser.stdout.on("data", listen);
  browser.stderr.on("data", listen);
  try {
    const marionette = new Marionette(await connected(port, browser));
    await marionette.next();  // its greeting
    await marionette.run("WebDriver:NewSession", { capabilities: {} });
    await marionette.run("WebDriver:SetTimeouts", { script: 300_000, pageLoad: 120_000 });
    await marionette.run("WebDriver:SetWindowRect", { width, height: height + 100 });
    problems.length = 0;  // those of the browser itself
    await marionette.run("WebDriver:Navigate", { url });
    const result = await use(new Page(marionette));
    require(problems.length === 0, problems.join("\n"));
    return result;
  } finally {
    try {
      process.kill(-browser.pid, "SIGKILL");  // and its own processes
    } catch {
      // it has ended
    }
    screen.removeAllListeners("exit");
    screen.kill("SIGKILL");
    await sleep(200);
    rmSync(profile, { recursive: true, force: true, maxRetries: 5 });
  }
}
