// Measures the page of `tools/ports/web` in Chromium, without WebGL: node measure-page.mjs FOLDER
//
// Prints the size of the module, the time to the first picture, the frames of an idle page, and those
// while the first scene is dragged at 1280x800. Only an idle machine gives figures of the page.
import { readFile } from "node:fs/promises";
import { join } from "node:path";
import { brotliCompressSync } from "node:zlib";
import { Browser, serve, sleep } from "./browser.mjs";

const STARTS = 3;
const DRAGS = 3;
const SECONDS = 4;

const [folder] = process.argv.slice(2);

// Notes each change of the canvas. The viewport is the large one.
const NOTE = `
  window.shown = [];
  const put = CanvasRenderingContext2D.prototype.putImageData;
  CanvasRenderingContext2D.prototype.putImageData = function (image, ...more) {
    if (image.width > 300 && image.height > 300) window.shown.push(performance.now());
    return put.call(this, image, ...more);
  };
`;

function quantile(list, part) {
  const sorted = [...list].sort((a, b) => a - b);
  return sorted[Math.min(sorted.length - 1, Math.floor(part * sorted.length))];
}

async function start(browser, site) {
  const tab = await browser.tab(await browser.visitor(), 1280, 800);
  await tab.send("Page.addScriptToEvaluateOnNewDocument", { source: NOTE });
  await tab.open(site);
  let first;
  while (!first) {
    await sleep(20);
    first = await tab.run(() => performance.getEntriesByName("first picture")[0]?.startTime ?? 0);
  }
  return [tab, first];
}

// Looks around with the right button for some seconds, in circles, with a move every 8 ms.
async function drag(tab) {
  const at = (time) => [450 + 120 * Math.cos(3 * time), 400 + 90 * Math.sin(3 * time)];
  await tab.mouse("mouseMoved", ...at(0));
  await tab.mouse("mousePressed", ...at(0), { button: "right", buttons: 2, clickCount: 1 });
  await tab.run(() => { window.shown.length = 0; });
  const begin = performance.now();
  for (let time = 0; time < SECONDS; time = (performance.now() - begin) / 1000) {
    await tab.mouse("mouseMoved", ...at(time), { button: "right", buttons: 2 });
    await sleep(8);
  }
  const shown = await tab.run(() => window.shown);
  await tab.mouse("mouseReleased", ...at(SECONDS), { button: "right", clickCount: 1 });
  return shown.slice(1).map((time, at) => time - shown[at]);
}

const module = await readFile(join(folder, "marraztu.wasm"));
console.log(`module: ${module.length} bytes, by brotli ${brotliCompressSync(module).length}`);
const served = await serve({ "": folder });
const browser = await Browser.start();
const firsts = [];
let tab;
for (let i = 0; i < STARTS; i++) {
  await tab?.close();
  let first;
  [tab, first] = await start(browser, served.address);
  firsts.push(first);
}
console.log(`first picture: ${firsts.map((time) => time.toFixed(0)).join(", ")} ms after the navigation began`);
await sleep(8000);
const before = await tab.run(() => window.framesAsked);
await sleep(5000);
console.log(`idle: ${(await tab.run(() => window.framesAsked)) - before} frames in 5 s`);
for (let i = 0; i < DRAGS; i++) {
  const gaps = await drag(tab);
  const [tenth, median, slow] = [0.1, 0.5, 0.9].map((part) => quantile(gaps, part).toFixed(1));
  const mean = gaps.reduce((sum, gap) => sum + gap, 0) / gaps.length;
  console.log(`dragging: ${(1000 / mean).toFixed(1)} pictures a second; between two of them ${tenth}, ${median} and ${slow} ms (10, 50 and 90%)`);
  await sleep(3000);
}
await browser.close();
served.close();
