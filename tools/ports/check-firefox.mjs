// Opens the page of `tools/ports/web` in Firefox, and fails if the console reports an error there:
// node check-firefox.mjs FOLDER [SECONDS]
//
// The view of the first scene changes twice a second, which interrupts the refinement of the picture.
// Marionette's protocol is used because pages and WebDriver do not get the messages of Firefox itself.
import { spawn } from "node:child_process";
import { mkdtemp, readFile, rm, writeFile } from "node:fs/promises";
import { connect } from "node:net";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { serve, sleep } from "./browser.mjs";

const [folder, seconds = "10"] = process.argv.slice(2);

class Firefox {
  static async start(program = "firefox-esr") {
    const firefox = new Firefox();
    firefox.profile = await mkdtemp(join(tmpdir(), "marraztu-firefox-"));
    // Marionette chooses a free port, and writes it into the profile.
    await writeFile(join(firefox.profile, "user.js"), 'user_pref("marionette.port", 0);\n');
    const options = ["--headless", "--no-remote", "--marionette", "--remote-allow-system-access", "--profile", firefox.profile];
    firefox.process = spawn(program, options, { stdio: "ignore" });
    firefox.waiting = new Map();
    firefox.count = 0;
    let port;
    for (let wait = 0; !port; wait++) {
      if (wait > 300) {
        throw new Error(`${program} does not start`);
      }
      await sleep(200);
      port = await readFile(join(firefox.profile, "MarionetteActivePort"), "utf8").catch(() => "");
    }
    firefox.socket = connect(Number(port), "127.0.0.1");
    let rest = Buffer.alloc(0);
    firefox.socket.on("data", (bytes) => {
      rest = Buffer.concat([rest, bytes]);
      // A message is its length, a colon, and JSON.
      for (;;) {
        const begin = rest.indexOf(":") + 1;
        const end = begin + Number(rest.subarray(0, begin - 1));
        if (begin === 0 || rest.length < end) {
          return;
        }
        firefox.hear(JSON.parse(rest.subarray(begin, end)));
        rest = rest.subarray(end);
      }
    });
    await firefox.send("WebDriver:NewSession");
    return firefox;
  }

  hear(message) {
    // The first message is a greeting.
    if (Array.isArray(message)) {
      const [, id, error, result] = message;
      const { resolve, reject } = this.waiting.get(id);
      error ? reject(new Error(`${error.error}: ${error.message}`)) : resolve(result);
    }
  }

  send(name, params = {}) {
    const id = ++this.count;
    const text = JSON.stringify([0, id, name, params]);
    this.socket.write(`${Buffer.byteLength(text)}:${text}`);
    return new Promise((resolve, reject) => this.waiting.set(id, { resolve, reject }));
  }

  // Runs a function in the page, or in the browser around it.
  async run(context, code, ...args) {
    await this.send("Marionette:SetContext", { value: context });
    const { value } = await this.send("WebDriver:ExecuteScript", { script: `return (${code})(...arguments)`, args });
    return value;
  }

  // Returns the errors that the console of the browser has reported about files of the page.
  faults(site) {
    return this.run("chrome", (site) => {
      const all = Services.console.getMessageArray().filter((it) => it instanceof Ci.nsIScriptError);
      const isError = (it) => !(it.flags & Ci.nsIScriptError.warningFlag);
      const ofPage = (it) => `${it.sourceName} ${it.errorMessage}`.includes(site.replace(/\/$/, ""));
      return all.filter((it) => isError(it) && ofPage(it)).map((it) => `${it.sourceName}: ${it.errorMessage}`);
    }, site);
  }

  async close() {
    const ended = new Promise((done) => this.process.on("exit", done));
    this.send("Marionette:Quit", { flags: ["eForceQuit"] }).catch(() => {});
    await ended;
    await rm(this.profile, { recursive: true, force: true, maxRetries: 5 });
  }
}

// Opens the page and turns the view. Returns the errors and the number of pictures.
async function watch(firefox, site) {
  await firefox.send("WebDriver:Navigate", { url: site });
  for (let wait = 0; (await firefox.run("content", () => document.getElementById("status").textContent)) !== ""; wait++) {
    if (wait > 300) {
      throw new Error("the editor does not start");
    }
    await sleep(200);
  }
  await firefox.run("content", () => {
    const canvas = document.getElementById("canvas");
    window.shown = 0;
    const put = CanvasRenderingContext2D.prototype.putImageData;
    CanvasRenderingContext2D.prototype.putImageData = function (...all) {
      window.shown += 1;
      return put.apply(this, all);
    };
    let turns = 0;
    setInterval(() => {
      turns += 1;
      canvas.dispatchEvent(new WheelEvent("wheel", { clientX: 300, clientY: 250, deltaY: turns % 2 ? 40 : -40 }));
    }, 500);
  });
  await sleep(1000 * Number(seconds));
  return [await firefox.faults(site), await firefox.run("content", () => window.shown)];
}

const served = await serve({ "": folder });
const firefox = await Firefox.start();
try {
  const [faults, shown] = await watch(firefox, served.address);
  const kinds = new Map();
  for (const fault of faults) {
    const kind = fault.replaceAll(/blob:\S+/g, "blob:...");
    kinds.set(kind, (kinds.get(kind) ?? 0) + 1);
  }
  kinds.forEach((count, kind) => console.error(`${count} x ${kind}`));
  console.log(`Firefox has shown ${shown} pictures in ${seconds} seconds, and reports ${faults.length} errors`);
  process.exitCode = faults.length > 0 || shown === 0 ? 1 : 0;
} finally {
  await firefox.close();
  served.close();
}
