// Workers: other instances of the module, with the same files. One draws the viewport; others measure
// for the laboratory, make files or draw comparisons, while they are asked to. The editor and its
// workers exchange messages that only they understand.

// A worker, and the files that it gets. `heard` takes each message; `failed` a fault.
function begin({ compiled, files }, heard, failed) {
  const worker = new Worker(new URL("worker.js", import.meta.url), { type: "module" });
  worker.onmessage = ({ data }) => heard(data);
  worker.onerror = (event) => failed(event.message || "a worker cannot start");
  worker.postMessage({ compiled, files: [...files.shared] });
  return worker;
}

// Copies bytes into a module.
function put(module, bytes) {
  // A call may move the memory, so the address comes first.
  const address = module.input(bytes.length);
  new Uint8Array(module.memory.buffer, address, bytes.length).set(bytes);
}

// Copies the output of a module.
function taken(module, length) {
  return new Uint8Array(module.memory.buffer, module.output(), length).slice();
}

export class Drawing {
  // Starts a worker. Fails if the browser does not allow one.
  static async start(source) {
    const drawing = new Drawing();
    drawing.source = source;
    const ready = new Promise((resolve, reject) => {
      drawing.worker = begin(source, resolve, reject);
    });
    source.files.changed = (path, bytes) => drawing.worker.postMessage({ path, bytes });
    await ready;
    return drawing;
  }

  // Lets the worker draw for an editor. `heard` is called after each reply.
  connect(editor, heard) {
    this.editor = editor;
    this.heard = heard;
    this.worker.onmessage = ({ data }) => this.take(data);
    this.worker.onerror = (event) => this.replace(event.message);
    editor.draw_elsewhere();
  }

  // A fault costs a picture: another worker draws the next one.
  replace(fault) {
    console.error(fault);
    this.worker.terminate();
    let isReady = false;
    const take = (reply) => (reply === "ready" ? (isReady = true) : this.take(reply));
    this.worker = begin(this.source, take, (fault) => (isReady ? this.replace(fault) : console.error(fault)));
    this.take(new Uint8Array(0));
  }

  take(reply) {
    put(this.editor, reply);
    this.editor.reply();
    this.exchange();
    this.heard();
  }

  // Passes the next request to the worker, if there is one.
  exchange() {
    const length = this.editor.request();
    if (length > 0) {
      const request = taken(this.editor, length);
      // Interrupts the refinement of the last picture: see worker.js.
      URL.revokeObjectURL(this.token);
      this.token = URL.createObjectURL(new Blob(["."]));
      this.worker.postMessage({ request, token: this.token }, [request.buffer]);
    }
  }
}

// The jobs of a kind, one at a time: 0 measures, 1 makes a file, 2 compares.
export class Jobs {
  // `heard` is called after each message.
  constructor(source, editor, kind, heard) {
    this.source = source;
    this.editor = editor;
    this.kind = kind;
    this.heard = heard;
    this.worker = null;
  }

  // Starts the next job, and stops one whose result is not awaited any more.
  exchange() {
    const length = this.editor.job(this.kind);
    if (length > 0 || this.editor.awaits(this.kind) === 0) {
      this.worker?.terminate();
      this.worker = null;
    }
    if (length > 0) {
      const job = taken(this.editor, length);
      // A worker that was stopped may have a result on its way.
      const take = (message) => worker === this.worker && this.take(message);
      const failed = (fault) => {
        console.error(fault);
        take({ end: new Uint8Array(0) });
      };
      const worker = begin(this.source, take, failed);
      worker.postMessage({ job }, [job.buffer]);
      this.worker = worker;
    }
  }

  take({ told, end, written = [] }) {
    if (told) {
      put(this.editor, new TextEncoder().encode(told));
      this.editor.told(this.kind);
    } else if (end) {
      // The files come first, since the end says that they are saved.
      for (const [path, bytes] of written) {
        this.source.files.takeWritten(path, bytes);
      }
      put(this.editor, end);
      this.editor.done(this.kind);
    } else {
      // The worker is ready.
      return;
    }
    this.heard();
  }
}
