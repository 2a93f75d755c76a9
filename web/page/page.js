// The page around the editor: it passes events to the WebAssembly module, copies changed rectangles
// to the canvas, and gives it files.
//
// A frame runs only after an event or when the editor has asked for one, so an idle page uses no
// processor time.
//
// ?model=URL opens a model or a scene, with the files that it refers to beside it. ?verify compares the
// listed pictures with those of this processor. In view.html, for other pages to embed, only the picture
// is shown, from the direction in ?view=.

import { ConsoleStdout, OpenFile, PreopenDirectory, File, WASI } from "./wasi/index.js";
import { Fetching } from "./fetching.js";
import { Files } from "./files.js";
import { Touches } from "./touches.js";
import { Drawing, Jobs } from "./workers.js";

const canvas = document.getElementById("canvas");
const text = document.getElementById("text");
const picker = document.getElementById("files");
const status = document.getElementById("status");
const pen = canvas.getContext("2d", { alpha: false });
const said = document.getElementById("said");
const files = new Files();
const isView = "view" in document.documentElement.dataset;
const encoder = new TextEncoder();
const decoder = new TextDecoder();

// The exports of the module: `editor` is set when the editor has started, as no event may come
// before.
let module = null;
let editor = null;
// Workers that draw, and that do jobs; without them, the editor does so itself.
let drawing = null;
let jobs = [];

function write(value) {
  const bytes = encoder.encode(value);
  const address = module.input(bytes.length);
  new Uint8Array(module.memory.buffer, address, bytes.length).set(bytes);
}

function read(length) {
  return JSON.parse(decoder.decode(new Uint8Array(module.memory.buffer, module.output(), length)));
}

function missing(path) {
  write(path);
  return read(module.missing());
}

const fetching = new Fetching(files, missing);

// Reports what stops the editor or the viewer.
function fail(error) {
  console.error(error);
  if (isView) {
    showInstead(`The viewer has stopped: ${error.message ?? error}. Reload the page to try again.`);
    return;
  }
  editor = null;
  const work = files.keeps() ? "; unsaved work is offered again" : "";
  status.textContent = `Marraztu has stopped: ${error}\nReload the page to go on${work}.`;
}

// Shows a sentence in place of the picture.
function showInstead(sentence) {
  editor = null;
  canvas.hidden = true;
  status.textContent = sentence;
}

// Sentences for the user that wait for the editor.
const waiting = [];

// Says something in a notice of the editor.
function tell(sentence) {
  if (!editor) {
    waiting.push(sentence);
    return;
  }
  write(sentence);
  editor.tell();
  schedule();
}

files.tell = tell;

// Frames.

let asked = false;
let timer = 0;

function schedule() {
  if (!asked && editor) {
    asked = true;
    requestAnimationFrame(run);
  }
}

function run(time) {
  asked = false;
  // The scale may change without an event. Fitting runs a frame.
  if (!editor || providing || fit()) {
    return;
  }
  try {
    editor.run(time / 1000);
    // The worker draws while the frame is painted.
    drawing?.exchange();
    obey(read(editor.paint()));
    jobs.forEach((job) => job.exchange());
  } catch (error) {
    fail(error);
  }
}

// Whether work would be lost with the page.
let isUnsaved = false;

window.addEventListener("beforeunload", (event) => {
  if (editor && isUnsaved) {
    // The browser asks whether to leave.
    event.preventDefault();
    event.returnValue = true;
  }
});

function obey(frame) {
  if (frame.fault) {
    showInstead(`The picture cannot be shown: ${frame.fault.replaceAll("/files/", "")}`);
    return;
  }
  isUnsaved = frame.unsaved;
  for (const [x, y, width, height] of frame.changed) {
    const address = editor.rgba(x, y, width, height);
    if (address) {
      const bytes = new Uint8ClampedArray(editor.memory.buffer, address, width * height * 4);
      pen.putImageData(new ImageData(bytes, width, height), x, y);
    }
  }
  canvas.style.cursor = frame.cursor;
  if (said.textContent !== frame.said) {
    said.textContent = frame.said;
  }
  if (frame.copied !== undefined) {
    copied = frame.copied;
    if (!copying) {
      // A menu or a button copies outside of a copy event.
      navigator.clipboard?.writeText(copied).catch(() => {});
    }
  }
  if (frame.picture) {
    copyPicture(...frame.picture);
  }
  if (frame.link) {
    window.open(frame.link, "_blank", "noopener");
  }
  // The hidden input is where the text is, so that input methods open their windows there.
  text.inputMode = frame.edited ? "text" : "none";
  if (frame.edited) {
    const [x, y, , height] = frame.edited;
    text.style.transform = `translate(${x}px, ${y + height}px)`;
  }
  if (frame.wants) {
    choose(frame.wants);
  }
  for (const [path, bytes] of files.written()) {
    download(path.split("/").pop(), bytes);
  }
  files.keep();
  clearTimeout(timer);
  if (frame.opening) {
    provide(frame.opening);
    return;
  }
  if (frame.due !== undefined) {
    if (frame.due < 5) {
      schedule();
    } else {
      timer = setTimeout(schedule, frame.due);
    }
  }
}

// Whether files are being fetched that the next frame reads.
let providing = false;

// Fetches the examples that scenes refer to. The next frame reads the scenes.
async function provide(scenes) {
  providing = true;
  for (const scene of scenes) {
    await fetching.examples(scene);
  }
  providing = false;
  schedule();
}

function hear(event) {
  if (!editor) {
    return;
  }
  try {
    write(JSON.stringify(event));
    editor.hear();
  } catch (error) {
    fail(error);
  }
  schedule();
}

// Pointer and keys.

const isMac = /Mac|iPhone|iPad/.test(navigator.platform);

function modifiers(event) {
  return (event.altKey ? 1 : 0) | (event.ctrlKey ? 2 : 0) | (event.shiftKey ? 4 : 0) | (event.metaKey && isMac ? 8 : 0);
}

const touches = new Touches(hear);

canvas.addEventListener("pointerdown", (event) => {
  event.preventDefault();
  if (!isView) {
    text.focus({ preventScroll: true });
  }
  canvas.setPointerCapture(event.pointerId);
  if (event.pointerType === "touch") {
    touches.down(event);
  } else {
    hear({ kind: "button", x: event.offsetX, y: event.offsetY, button: event.button, pressed: true, modifiers: modifiers(event) });
  }
});

canvas.addEventListener("pointermove", (event) => {
  if (event.pointerType === "touch") {
    touches.move(event);
  } else {
    hear({ kind: "moved", x: event.offsetX, y: event.offsetY, modifiers: modifiers(event) });
    // Another button than the first one is pressed or released by a move.
    if (event.button > 0) {
      const pressed = (event.buttons & [1, 4, 2][event.button]) !== 0;
      hear({ kind: "button", x: event.offsetX, y: event.offsetY, button: event.button, pressed, modifiers: modifiers(event) });
    }
  }
});

canvas.addEventListener("pointerup", (event) => {
  if (event.pointerType === "touch") {
    touches.up(event);
  } else {
    hear({ kind: "button", x: event.offsetX, y: event.offsetY, button: event.button, pressed: false, modifiers: modifiers(event) });
  }
});

canvas.addEventListener("pointercancel", (event) => {
  if (event.pointerType === "touch") {
    touches.up(event);
  }
});

canvas.addEventListener("pointerleave", (event) => {
  if (event.pointerType !== "touch") {
    hear({ kind: "gone" });
  }
});

canvas.addEventListener("contextmenu", (event) => event.preventDefault());

canvas.addEventListener("wheel", (event) => {
  event.preventDefault();
  // Browsers report a pinch on a touchpad as a wheel with Ctrl.
  if (event.ctrlKey && event.deltaMode === 0 && !Number.isInteger(event.deltaY)) {
    hear({ kind: "zoom", factor: Math.exp(-event.deltaY / 100) });
  } else {
    hear({ kind: "wheel", x: event.deltaX, y: event.deltaY, mode: event.deltaMode, modifiers: modifiers(event) });
  }
}, { passive: false });

// The keys that the browser keeps: they copy, cut and paste, reload, or open tools of developers.
function isOfBrowser(event) {
  const command = event.ctrlKey || event.metaKey;
  // Of layouts without Latin letters, the places of the keys count.
  const letter = (/^[^\x00-\x7f]$/.test(event.key) ? event.code.replace(/^Key/, "") : event.key).toLowerCase();
  return (command && !event.shiftKey && !event.altKey && ["c", "x", "v", "r"].includes(letter))
    || (command && event.shiftKey && ["i", "j"].includes(letter))
    || event.key === "F11";
}

// The keys that are down together with Ctrl or Cmd, by their places. On a Mac, browsers do not report the
// release of a key while Cmd is down: its next press and the release of Cmd end its press.
const commanded = new Map();

function release(code, event) {
  if (commanded.has(code)) {
    hear({ kind: "key", key: commanded.get(code), code, pressed: false, repeat: false, modifiers: modifiers(event) });
    commanded.delete(code);
  }
}

function key(event, pressed) {
  if (event.isComposing || event.key === "Process" || event.key === "Unidentified") {
    return;
  }
  const isCommand = event.key === "Control" || event.key === "Meta";
  if (isCommand && !pressed) {
    [...commanded.keys()].forEach((code) => release(code, event));
  }
  if (pressed && !event.repeat) {
    release(event.code, event);
  }
  if (pressed && !isCommand && (event.ctrlKey || event.metaKey)) {
    commanded.set(event.code, event.key);
  } else {
    commanded.delete(event.code);
  }
  // The clipboard's events report presses, but not releases.
  if (pressed && isOfBrowser(event)) {
    return;
  }
  hear({ kind: "key", key: event.key, code: event.code, pressed, repeat: event.repeat, modifiers: modifiers(event) });
  // Keys that write a letter go on to the hidden input.
  // AltGr reports Ctrl and Alt on Windows; a dead key waits for its letter.
  const isLetter = event.key.length === 1 && ((!event.ctrlKey && !event.metaKey) || event.getModifierState("AltGraph"));
  const writes = isLetter || event.key === "Dead";
  if (!writes) {
    event.preventDefault();
  }
}

text.addEventListener("keydown", (event) => key(event, true));
text.addEventListener("keyup", (event) => key(event, false));
text.addEventListener("input", (event) => {
  if (event.isComposing) {
    return;
  }
  if (text.value) {
    hear({ kind: "text", text: text.value });
  }
  text.value = "";
});
text.addEventListener("compositionupdate", (event) => hear({ kind: "preedit", text: event.data }));
text.addEventListener("compositionend", (event) => {
  hear({ kind: "commit", text: event.data });
  text.value = "";
});
window.addEventListener("focus", () => {
  if (!isView) {
    text.focus({ preventScroll: true });
  }
  hear({ kind: "focus", focused: true });
});
window.addEventListener("blur", () => hear({ kind: "focus", focused: false }));

// The clipboard: browsers give access only during its events.

let copied = "";
let copying = false;

// The editor takes such an event for the press of a key. A menu of the browser has no key to release.
function hearClipboard(event, key) {
  hear(event);
  if (commanded.size === 0) {
    hear({ kind: "key", key, code: "", pressed: false, repeat: false, modifiers: 0 });
  }
}

function copy(event, kind, key) {
  copied = "";
  copying = true;
  hearClipboard({ kind }, key);
  run(performance.now());
  copying = false;
  if (copied) {
    event.clipboardData.setData("text/plain", copied);
  }
  event.preventDefault();
}

async function copyPicture(width, height) {
  const bytes = new Uint8ClampedArray(editor.memory.buffer, editor.picture(), width * height * 4).slice();
  const sheet = new OffscreenCanvas(width, height);
  sheet.getContext("2d").putImageData(new ImageData(bytes, width, height), 0, 0);
  const blob = sheet.convertToBlob({ type: "image/png" });
  await navigator.clipboard?.write([new ClipboardItem({ "image/png": blob })]).catch((error) => {
    tell(`The picture was not copied: ${error.message}`);
  });
}

document.addEventListener("copy", (event) => copy(event, "copy", "c"));
document.addEventListener("cut", (event) => copy(event, "cut", "x"));
document.addEventListener("paste", (event) => {
  event.preventDefault();
  const pasted = event.clipboardData.getData("text/plain");
  if (pasted) {
    hearClipboard({ kind: "paste", text: pasted }, "v");
  }
});

// Files.

// Adds files of the user. Returns the paths of those to open.
async function add(list) {
  const contents = [];
  for (const [name, file] of list) {
    try {
      contents.push([name, new Uint8Array(await file.arrayBuffer())]);
    } catch (error) {
      // The file may be gone, or not readable.
      tell(`${name} cannot be read: ${error.message}`);
    }
  }
  // Objects keep their files: others of the same names go to a folder.
  const folder = files.freeFolder(contents);
  const paths = opened(contents.map(([name, bytes]) => files.add(folder + name, bytes)));
  if (folder) {
    // A model that was chosen alone uses the MTL files and textures that are there.
    for (const path of paths) {
      await fetching.others(path, async (other) => files.outside(other, folder));
    }
  }
  return paths;
}

// Of several files, models and scenes are opened; the others are what they refer to.
function opened(paths) {
  const models = paths.filter((path) => /\.((obj|stl)(\.gz)?|marraztu)$/i.test(path));
  return models.length > 0 ? models : paths;
}

function choose(endings) {
  // An ending such as .gz is too narrow a filter together with .mtl and textures.
  const isModel = endings.includes("obj");
  picker.accept = isModel ? "" : endings.map((ending) => `.${ending}`).join(",");
  picker.value = "";
  picker.click();
}

picker.addEventListener("change", async () => {
  const paths = await add([...picker.files].map((file) => [file.name, file]));
  write(paths.join("\n"));
  editor.answer();
  schedule();
});

picker.addEventListener("cancel", () => {
  write("");
  editor.answer();
  schedule();
});

canvas.addEventListener("dragover", (event) => event.preventDefault());
canvas.addEventListener("drop", async (event) => {
  event.preventDefault();
  // Both lists are read before the first wait, which empties them.
  const entries = [...event.dataTransfer.items].map((item) => item.webkitGetAsEntry?.()).filter(Boolean);
  const list = entries.length > 0 ? [] : [...event.dataTransfer.files].map((file) => [file.name, file]);
  for (const entry of entries) {
    await walk(entry, "", list);
  }
  if (list.length === 0 || !editor) {
    return;
  }
  const paths = await add(list);
  write(paths.join("\n"));
  editor.drop_files();
  schedule();
});

// Lists the files of a dropped entry, which may be a folder.
async function walk(entry, folder, list) {
  if (entry.isFile) {
    list.push([folder + entry.name, await new Promise((resolve, reject) => entry.file(resolve, reject))]);
    return;
  }
  const reader = entry.createReader();
  for (;;) {
    const entries = await new Promise((resolve, reject) => reader.readEntries(resolve, reject));
    if (entries.length === 0) {
      return;
    }
    for (const inner of entries) {
      await walk(inner, `${folder}${entry.name}/`, list);
    }
  }
}

function download(name, bytes) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([bytes]));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}

// The size of the canvas.

let size = [0, 0];

function measure() {
  const scale = window.devicePixelRatio || 1;
  const width = Math.max(1, Math.round(canvas.clientWidth * scale));
  const height = Math.max(1, Math.round(canvas.clientHeight * scale));
  return [width, height, scale];
}

function fit() {
  const [width, height, scale] = measure();
  if (!editor || (width === size[0] && height === size[1] && scale === size[2])) {
    return false;
  }
  size = [width, height, scale];
  canvas.width = width;
  canvas.height = height;
  editor.resize(width, height, scale);
  run(performance.now());
  return true;
}

// Another screen may change the scale alone, without a resize.
function watchScale() {
  const screen = matchMedia(`(resolution: ${window.devicePixelRatio}dppx)`);
  screen.addEventListener("change", () => {
    fit();
    watchScale();
  }, { once: true });
}

// Leaves the keyboard to the page around the picture.
function showPictureOnly(query) {
  write(query.get("view") ?? "");
  if (editor.show_picture_only() !== 0) {
    showInstead(`view=${query.get("view")}: write degrees to the right and up, as 30,20, or front, right, back, left, top, bottom, iso`);
  }
}

async function begin() {
  const console_ = ConsoleStdout.lineBuffered((line) => console.log(line));
  const fds = [new OpenFile(new File([])), console_, console_, new PreopenDirectory("/", files.root(!isView))];
  const wasi = new WASI(["marraztu"], [], fds, { debug: false });
  // The module is compiled while it arrives, and while files are restored.
  const arriving = WebAssembly.compileStreaming(fetch("marraztu.wasm"));
  if (!isView) {
    await files.restore();
  }
  const compiled = await arriving;
  const source = { compiled, files };
  const started = Drawing.start(source);
  const instance = await WebAssembly.instantiate(compiled, { wasi_snapshot_preview1: wasi.wasiImport });
  wasi.initialize(instance);
  module = instance.exports;
  const query = new URLSearchParams(location.search);
  if (query.has("verify")) {
    const begun = performance.now();
    const { all, differing } = read(module.verify());
    const seconds = ((performance.now() - begun) / 1000).toFixed(1);
    status.textContent = [`${all - differing.length} of ${all} pictures are as listed (${seconds} s)`, ...differing].join("\n");
    return;
  }
  const model = query.get("model");
  if (isView && model) {
    document.getElementById("open").search = new URLSearchParams({ model });
  }
  let path = "";
  if (model) {
    status.textContent = `Loading ${model} ...`;
    try {
      path = await fetching.model(model);
    } catch (error) {
      console.error(error);
      if (isView) {
        showInstead(`The picture cannot be shown: ${error.message}`);
        return;
      }
      // The editor starts without the model, and says why.
      tell(`The file was not opened: ${error.message}`);
    }
  }
  size = measure();
  [canvas.width, canvas.height] = size;
  write(path);
  if (module.start(...size) !== 0) {
    throw new Error("the editor cannot start");
  }
  drawing = await started.catch((error) => {
    console.warn("No worker draws:", error);
    return null;
  });
  if (drawing) {
    drawing.connect(module, schedule);
    jobs = [0, 1, 2].map((kind) => new Jobs(source, module, kind, schedule));
  }
  editor = module;
  status.textContent = "";
  if (isView) {
    showPictureOnly(query);
  } else {
    text.focus({ preventScroll: true });
  }
  waiting.splice(0).forEach(tell);
  new ResizeObserver(fit).observe(canvas);
  watchScale();
  run(performance.now());
  performance.mark("first picture");
}

begin().catch(fail);
