// Drives Debian's Chromium over a pipe, in Chrome's DevTools protocol: real keys, pointer, files,
// reloads and crashes.
import { spawn } from "node:child_process";
import { createServer } from "node:http";
import { mkdtemp, readFile, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { extname, join, normalize } from "node:path";

export const sleep = (ms) => new Promise((done) => setTimeout(done, ms));

const TYPES = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".wasm": "application/wasm" };

// Serves folders by the first part of the path, and one folder, "", for all other paths.
export async function serve(folders) {
  const server = createServer(async (request, response) => {
    const path = normalize(decodeURIComponent(new URL(request.url, "http://localhost").pathname));
    const [, first, ...rest] = path.split("/");
    const file = first && first in folders ? join(folders[first], ...rest) : join(folders[""], path);
    try {
      const whole = path.endsWith("/") ? join(file, "index.html") : file;
      const type = TYPES[extname(whole)] ?? "application/octet-stream";
      const bytes = await readFile(whole);
      response.writeHead(200, { "content-type": type, "access-control-allow-origin": "*" }).end(bytes);
    } catch {
      response.writeHead(404).end();
    }
  });
  await new Promise((done) => server.listen(0, "127.0.0.1", done));
  return { address: `http://localhost:${server.address().port}/`, close: () => server.close() };
}

export class Browser {
  static async start(program = "chromium") {
    const browser = new Browser();
    browser.folder = await mkdtemp(join(tmpdir(), "marraztu-page-"));
    browser.waiting = new Map();
    browser.listeners = new Set();
    browser.count = 0;
    const options = [
      "--headless=new", "--remote-debugging-pipe", `--user-data-dir=${join(browser.folder, "profile")}`,
      "--no-first-run", "--disable-gpu", "--disable-3d-apis", "--disable-dev-shm-usage",
      // As root, as in a container, Chromium runs only without its sandbox.
      ...(process.getuid() === 0 ? ["--no-sandbox"] : []),
      "about:blank",
    ];
    browser.process = spawn(program, options, { stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"] });
    const ended = new Promise((_, reject) => {
      browser.process.on("error", reject);
      browser.process.on("exit", (code) => reject(new Error(`${program} has ended (${code})`)));
    });
    ended.catch((error) => browser.waiting.forEach(({ reject }) => reject(error)));
    let rest = Buffer.alloc(0);
    browser.process.stdio[4].on("data", (bytes) => {
      const parts = [rest, bytes];
      rest = Buffer.concat(parts);
      for (let end = rest.indexOf(0); end >= 0; end = rest.indexOf(0)) {
        browser.hear(JSON.parse(rest.subarray(0, end)));
        rest = rest.subarray(end + 1);
      }
    });
    await browser.send("Browser.getVersion");
    browser.downloads = join(browser.folder, "downloads");
    return browser;
  }

  hear({ id, sessionId, method, params, result, error }) {
    if (id === undefined) {
      this.listeners.forEach((listener) => listener(method, params, sessionId));
      return;
    }
    const { resolve, reject, name } = this.waiting.get(id);
    this.waiting.delete(id);
    if (error) {
      reject(new Error(`${name}: ${error.message}`));
    } else {
      resolve(result);
    }
  }

  send(name, params = {}, sessionId = undefined) {
    const id = ++this.count;
    this.process.stdio[3].write(`${JSON.stringify({ id, method: name, params, sessionId })}\0`);
    return new Promise((resolve, reject) => this.waiting.set(id, { resolve, reject, name }));
  }

  // Waits for an event.
  event(name, sessionId = undefined) {
    return new Promise((resolve) => {
      const listener = (method, params, from) => {
        if (method === name && (sessionId === undefined || from === sessionId)) {
          this.listeners.delete(listener);
          resolve(params);
        }
      };
      this.listeners.add(listener);
    });
  }

  // Returns a profile: it has its own storage, as of another visitor.
  async visitor() {
    const { browserContextId } = await this.send("Target.createBrowserContext");
    const download = { behavior: "allowAndName", downloadPath: this.downloads, eventsEnabled: true };
    await this.send("Browser.setDownloadBehavior", { browserContextId, ...download });
    return browserContextId;
  }

  // Opens a tab of this size.
  async tab(browserContextId, width, height, scale = 1) {
    const { targetId } = await this.send("Target.createTarget", { url: "about:blank", browserContextId });
    const { sessionId } = await this.send("Target.attachToTarget", { targetId, flatten: true });
    const tab = new Tab(this, targetId, sessionId);
    await tab.send("Page.enable");
    await tab.send("Runtime.enable");
    await tab.send("Page.addScriptToEvaluateOnNewDocument", { source: COUNT });
    await tab.resize(width, height, scale);
    return tab;
  }

  async close() {
    this.process.removeAllListeners("exit");
    const ended = new Promise((done) => this.process.on("exit", done));
    this.send("Browser.close").catch(() => {});
    await ended;
    await rm(this.folder, { recursive: true, force: true, maxRetries: 5 });
  }
}

// Counts the frames that a page asks for.
const COUNT = `
  window.framesAsked = 0;
  const ask = window.requestAnimationFrame.bind(window);
  window.requestAnimationFrame = (run) => { window.framesAsked += 1; return ask(run); };
`;

// The keys that are not letters, with their Windows codes, as the protocol wants them.
const CODES = { Enter: 13, Escape: 27, Tab: 9, Delete: 46, F1: 112, F5: 116, Control: 17, Shift: 16 };
const MODIFIERS = { Alt: 1, Control: 2, Shift: 8 };

export class Tab {
  constructor(browser, target, session) {
    // `leaves` answers when the browser asks whether to leave a page; `asked` counts that.
    Object.assign(this, { browser, target, session, faults: [], leaves: true, asked: 0 });
    browser.listeners.add((method, params, from) => {
      if (from === session && method === "Runtime.exceptionThrown") {
        const { text, exception } = params.exceptionDetails;
        this.faults.push(exception?.description ?? text);
      } else if (from === session && method === "Page.javascriptDialogOpening") {
        this.asked += 1;
        this.send("Page.handleJavaScriptDialog", { accept: this.leaves });
      }
    });
  }

  send(name, params) {
    return this.browser.send(name, params, this.session);
  }

  resize(width, height, scale = 1, mobile = false) {
    return this.send("Emulation.setDeviceMetricsOverride", { width, height, deviceScaleFactor: scale, mobile });
  }

  async open(url) {
    const loaded = this.browser.event("Page.loadEventFired", this.session);
    await this.send("Page.navigate", { url });
    await loaded;
  }

  async reload() {
    const loaded = this.browser.event("Page.loadEventFired", this.session);
    await this.send("Page.reload");
    await loaded;
  }

  // Ends the process of the tab, as a lack of memory would.
  async crash() {
    const crashed = this.browser.event("Inspector.targetCrashed", this.session);
    this.send("Page.crash").catch(() => {});
    await crashed;
    await this.close();
  }

  close() {
    return this.browser.send("Target.closeTarget", { targetId: this.target });
  }

  // Runs a function in the page.
  async run(code, ...values) {
    const expression = `(${code})(...${JSON.stringify(values)})`;
    const { result, exceptionDetails } = await this.send("Runtime.evaluate", { expression, awaitPromise: true, returnByValue: true });
    if (exceptionDetails) {
      throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
    }
    return result.value;
  }

  // Returns a PNG of the tab.
  async picture() {
    const { data } = await this.send("Page.captureScreenshot");
    return Buffer.from(data, "base64");
  }

  // Returns red, green and blue of a pixel of the tab, frames of other pages included.
  async shown(x, y) {
    const picture = (await this.picture()).toString("base64");
    return this.run(async (picture, x, y) => {
      const response = await fetch(`data:image/png;base64,${picture}`);
      const copy = new OffscreenCanvas(1, 1).getContext("2d");
      copy.drawImage(await createImageBitmap(await response.blob()), -x, -y);
      return Array.from(copy.getImageData(0, 0, 1, 1).data.slice(0, 3));
    }, picture, x, y);
  }

  // Presses keys such as "x" or "Control+Shift+R", the last one several times while the others are down.
  async press(chord, times = 1) {
    const held = chord.split("+");
    const last = held.pop();
    const presses = Array.from({ length: times }, () => [["keyDown", last], ["keyUp", last]]);
    const strokes = [
      ...held.map((key) => ["keyDown", key]), ...presses.flat(), ...held.toReversed().map((key) => ["keyUp", key]),
    ];
    let modifiers = 0;
    for (const [type, key] of strokes) {
      if (type === "keyUp" && key in MODIFIERS) modifiers &= ~MODIFIERS[key];
      if (type === "keyDown" && key in MODIFIERS) modifiers |= MODIFIERS[key];
      const isText = key.length === 1;
      const code = /^[a-z0-9]$/i.test(key) ? key.toUpperCase().charCodeAt(0) : CODES[key];
      const writes = isText && (modifiers & ~MODIFIERS.Shift) === 0;
      await this.send("Input.dispatchKeyEvent", {
        type: type === "keyDown" && !writes && key !== "Enter" ? "rawKeyDown" : type,
        key, modifiers, windowsVirtualKeyCode: code,
        code: /^[a-z]$/i.test(key) ? `Key${key.toUpperCase()}` : isText ? "" : key,
        text: type === "keyUp" ? undefined : writes ? key : key === "Enter" ? "\r" : undefined,
      });
    }
  }

  async type(text) {
    for (const key of text) {
      await this.press(key);
    }
  }

  mouse(type, x, y, more = {}) {
    return this.send("Input.dispatchMouseEvent", { type, x, y, button: "none", ...more });
  }

  async click(x, y) {
    await this.mouse("mouseMoved", x, y);
    await this.mouse("mousePressed", x, y, { button: "left", buttons: 1, clickCount: 1 });
    await this.mouse("mouseReleased", x, y, { button: "left", clickCount: 1 });
  }

  async drag([x, y], [toX, toY], steps = 10) {
    await this.mouse("mouseMoved", x, y);
    await this.mouse("mousePressed", x, y, { button: "left", buttons: 1, clickCount: 1 });
    for (let step = 1; step <= steps; step++) {
      const part = step / steps;
      await this.mouse("mouseMoved", x + (toX - x) * part, y + (toY - y) * part, { button: "left", buttons: 1 });
    }
    await this.mouse("mouseReleased", toX, toY, { button: "left", clickCount: 1 });
  }

  touch(type, ...points) {
    return this.send("Input.dispatchTouchEvent", { type, touchPoints: points.map(([x, y], id) => ({ x, y, id })) });
  }

  // Drops files and folders of this computer on the page.
  async drop(x, y, files) {
    const data = { items: [], files, dragOperationsMask: 1 };
    for (const type of ["dragEnter", "dragOver", "drop"]) {
      await this.send("Input.dispatchDragEvent", { type, x, y, data });
    }
  }

  // Does something that opens a file dialog, and chooses files of this computer there.
  async choose(files, act) {
    await this.send("Page.setInterceptFileChooserDialog", { enabled: true });
    const opened = this.browser.event("Page.fileChooserOpened", this.session);
    await act();
    const { backendNodeId } = await opened;
    await this.send("DOM.setFileInputFiles", { files, backendNodeId });
  }

  // Does something that downloads a file. Returns its name and its bytes.
  async download(act) {
    const begun = this.browser.event("Browser.downloadWillBegin");
    const finished = new Promise((resolve) => {
      const listener = (method, params) => {
        if (method === "Browser.downloadProgress" && params.state === "completed") {
          this.browser.listeners.delete(listener);
          resolve();
        }
      };
      this.browser.listeners.add(listener);
    });
    await act();
    const { guid, suggestedFilename } = await begun;
    await finished;
    return [suggestedFilename, await readFile(join(this.browser.downloads, guid))];
  }
}
