// Runs the editor of `tools/ports/web` without a browser: node check-web.mjs FOLDER PICTURE.ppm
//
// It compares all listed pictures, and writes what the editor shows of the first scene, without
// overlays and refined. That has to be the picture of `marraztu render --samples 16`, of its size.
// As in the page, a second instance draws it.
import { readFile, writeFile } from "node:fs/promises";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";

const [folder, picture] = process.argv.slice(2);
const shim = pathToFileURL(resolve(folder, "wasi/index.js")).href;
const { ConsoleStdout, Directory, File, OpenFile, PreopenDirectory, WASI } = await import(shim);

const module = await WebAssembly.compile(await readFile(resolve(folder, "marraztu.wasm")));

async function begin() {
  const say = ConsoleStdout.lineBuffered((line) => console.error(line));
  const root = new Map([["files", new Directory(new Map())], ["own", new Directory(new Map())]]);
  const fds = [new OpenFile(new File([])), say, say, new PreopenDirectory("/", root)];
  const wasi = new WASI(["marraztu"], [], fds, { debug: false });
  const instance = await WebAssembly.instantiate(module, { wasi_snapshot_preview1: wasi.wasiImport });
  wasi.initialize(instance);
  return instance.exports;
}

const editor = await begin();
const drawing = await begin();

function put(bytes, instance) {
  // A call may move the memory, so the address comes first.
  const address = instance.input(bytes.length);
  new Uint8Array(instance.memory.buffer, address, bytes.length).set(bytes);
}

function taken(length, instance) {
  return Buffer.from(instance.memory.buffer, instance.output(), length);
}

const write = (text) => put(new TextEncoder().encode(text), editor);
const read = (length) => JSON.parse(taken(length, editor).toString());

function fail(reason) {
  console.error(`check-web: ${reason}`);
  process.exit(1);
}

const { all, differing } = read(editor.verify());
console.log(`${all - differing.length} of ${all} pictures are as listed (WebAssembly)`);
if (all === 0 || differing.length > 0) {
  fail(`these pictures differ: ${differing.join(", ")}`);
}

const [width, height] = [1280, 800];
let now = 0;

// Passes messages until the second instance waits. Returns the milliseconds until it draws, or -1.
let replies = 0;

function exchange() {
  for (;;) {
    const length = editor.request();
    if (length > 0) {
      put(taken(length, editor), drawing);
      drawing.ask();
    }
    if (drawing.rest() !== 0) {
      return drawing.rest();
    }
    const reply = drawing.work();
    if (reply > 0) {
      put(taken(reply, drawing), editor);
      editor.reply();
      replies++;
    }
  }
}

// Runs frames until none is due, except for a text cursor that blinks.
async function rest() {
  for (let count = 0; count < 3000; count++) {
    editor.run(now);
    const { due } = read(editor.paint());
    const isIdle = exchange() < 0;
    if (isIdle && (due === undefined || due >= 400)) {
      return;
    }
    now += Math.max(due ?? 5, 5) / 1000;
    await new Promise((done) => setTimeout(done, 5));
  }
  fail("the editor never rests");
}

async function hear(...events) {
  for (const event of events) {
    write(JSON.stringify(event));
    if (editor.hear() !== 0) {
      fail(`this event is not understood: ${JSON.stringify(event)}`);
    }
  }
  await rest();
}

const press = (key, modifiers = 0, code = "") =>
  [true, false].map((pressed) => ({ kind: "key", key, code, pressed, repeat: false, modifiers }));

write("");
if (editor.start(width, height, 1) !== 0) {
  fail("the editor does not start");
}
editor.draw_elsewhere();
await rest();
// Ctrl+K of a Russian layout.
await hear(...press("л", 2, "KeyK"));
await hear({ kind: "text", text: "overlays" });
await hear(...press("Enter"));

// The background of the first scene is blue; the picture is the rectangle around a blue pixel.
const address = editor.rgba(0, 0, width, height);
const pixels = Buffer.from(editor.memory.buffer, address, 4 * width * height);
const isBlue = (x, y) => pixels.readUIntBE(4 * (y * width + x), 3) === 0x0000b3;
let [left, right, top, bottom] = [640, 640, 200, 200];
if (!isBlue(left, top)) {
  fail("the first scene is not shown");
}
while (isBlue(left - 1, top)) left--;
while (isBlue(right, top)) right++;
while (isBlue(left, top - 1)) top--;
while (isBlue(left, bottom)) bottom++;
const rows = [];
for (let y = top; y < bottom; y++) {
  for (let x = left; x < right; x++) {
    const at = 4 * (y * width + x);
    rows.push(pixels.subarray(at, at + 3));
  }
}
await writeFile(picture, Buffer.concat([Buffer.from(`P6\n${right - left} ${bottom - top}\n255\n`), ...rows]));
console.log(`the second instance has drawn it, in ${replies} replies`);
console.log(`${right - left}x${bottom - top}`);
