// Draws the viewport for the editor in the page, or does jobs for it: see workers.js.

import { ConsoleStdout, Fd, PreopenDirectory, WASI } from "./wasi/index.js";
import { Files } from "./files.js";

const files = new Files();
let module = null;

// Work is a task of its own, behind the messages that wait: a newer request replaces an older one.
const tasks = new MessageChannel();
let isQueued = false;
let timer = 0;

function queue() {
  if (!isQueued) {
    isQueued = true;
    tasks.port2.postMessage(null);
  }
}

tasks.port1.onmessage = () => {
  isQueued = false;
  clearTimeout(timer);
  // Most pictures are drawn in less time than a look for news takes.
  looked = performance.now();
  const length = module.work();
  if (length > 0) {
    const reply = new Uint8Array(module.memory.buffer, module.output(), length).slice();
    postMessage(reply, [reply.buffer]);
  }
  const rest = module.rest();
  if (rest === 0) {
    queue();
  } else if (rest > 0) {
    timer = setTimeout(queue, rest);
  }
};

self.onmessage = ({ data }) => {
  if (data.compiled) {
    begin(data);
  } else if (data.request) {
    put(data.request);
    token = data.token;
    module.ask();
    queue();
  } else if (data.job) {
    put(data.job);
    const length = module.do_job();
    const end = new Uint8Array(module.memory.buffer, module.output(), length).slice();
    postMessage({ end, written: files.written() }, [end.buffer]);
  } else {
    files.take(data.path, data.bytes);
    // A picture does not depend on the scene's own file, which is saved often.
    if (!data.path.endsWith(".marraztu")) {
      module.files_changed();
    }
  }
};

// While a picture is refined, no message arrives. The page revokes this URL when it sends a request,
// and a request to the URL fails then: the only news that a busy worker gets without special headers.
let token = "";
let looked = 0;
let canLook = false;

function isRevoked() {
  const request = new XMLHttpRequest();
  request.open("GET", token, false);
  // Firefox parses an answer without a type as XML, and logs an error.
  request.responseType = "arraybuffer";
  try {
    request.send();
    return request.status !== 200;
  } catch {
    return true;
  }
}

// The standard input has a byte when a request waits.
class Requests extends Fd {
  fd_read() {
    const now = performance.now();
    if (!canLook || !token || now - looked < 20) {
      return { ret: 0, data: new Uint8Array(0) };
    }
    looked = now;
    return { ret: 0, data: new Uint8Array(isRevoked() ? 1 : 0) };
  }
}

function put(bytes) {
  // A call may move the memory, so the address comes first.
  const address = module.input(bytes.length);
  new Uint8Array(module.memory.buffer, address, bytes.length).set(bytes);
}

function begin({ compiled, files: all }) {
  // What a job tells is a line of the standard output.
  const told = ConsoleStdout.lineBuffered((line) => postMessage({ told: line }));
  const faults = ConsoleStdout.lineBuffered((line) => console.error(line));
  const fds = [new Requests(), told, faults, new PreopenDirectory("/", files.root(false))];
  const wasi = new WASI(["marraztu"], [], fds, { debug: false });
  for (const [path, bytes] of all) {
    files.take(path, bytes);
  }
  token = URL.createObjectURL(new Blob(["."]));
  canLook = !isRevoked();
  token = "";
  const instance = new WebAssembly.Instance(compiled, { wasi_snapshot_preview1: wasi.wasiImport });
  wasi.initialize(instance);
  module = instance.exports;
  postMessage("ready");
}
