// The files of the editor: a file system in memory, with the folder /files for the user's files,
// /examples for those of the built-in examples, and /own for preferences and unsaved work. IndexedDB
// keeps /own for the next visit.

import { Directory, File } from "./wasi/index.js";

const DATABASE = "marraztu";
const STORE = "own";
// The user's files, by path: unsaved work refers to them.
const USER = "files";

export class Files {
  constructor() {
    this.user = new Directory(new Map());
    this.own = new Directory(new Map());
    this.examples = new Directory(new Map());
    // The content of each file of the user that the page knows.
    this.known = new Map();
    // The content of /own that the database has.
    this.kept = new Map();
    this.database = null;
    // The files that workers need, by path, and what is called with each one that is new or has changed.
    this.shared = new Map();
    this.changed = () => {};
    // Called with a sentence for the user.
    this.tell = () => {};
    this.hasFailed = false;
  }

  // The root folder, for WASI. Without /own, the editor keeps nothing.
  root(keeps = true) {
    const own = keeps ? [["own", this.own]] : [];
    return new Map([["files", this.user], ["examples", this.examples], ...own]);
  }

  // Adds a file of the user, in folders like those of its name. Returns its path.
  add(name, bytes) {
    const path = normal(name) || "file";
    const file = put(this.user, path, bytes);
    this.known.set(path, file.data);
    this.share(`/files/${path}`, bytes);
    // Without room the editor works; recovered work then lacks this file.
    this.store(USER)?.put(bytes, path);
    return `/files/${path}`;
  }

  // Returns whether unsaved work is kept for the next visit.
  keeps() {
    return this.database !== null;
  }

  // Returns a store of the database to write to, if there is one.
  store(name) {
    try {
      const transaction = this.database?.transaction(name, "readwrite");
      transaction?.addEventListener("abort", () => this.fail(transaction.error));
      return transaction?.objectStore(name);
    } catch (error) {
      // The user may have deleted the data of the page.
      this.fail(error);
      return undefined;
    }
  }

  fail(error) {
    console.warn("A file is not kept:", error);
    if (!this.hasFailed) {
      this.hasFailed = true;
      this.tell("The browser does not keep unsaved work for the next visit: save the scene before you leave the page");
    }
  }

  // Returns the first of the folders "", "2/", "3/" ... where none of these files, names and bytes, replaces
  // another one. Scenes may be replaced: no object refers to them.
  freeFolder(list) {
    const isFree = (path, bytes) => {
      const known = this.known.get(normal(path));
      return !known || /\.marraztu$/i.test(path) || isEqual(known, bytes);
    };
    for (let number = 1; ; number++) {
      const folder = number === 1 ? "" : `${number}/`;
      if (list.every(([name, bytes]) => isFree(folder + name, bytes))) {
        return folder;
      }
    }
  }

  // Returns the content of a user's file by its path. A path in `folder` stands for the same one outside.
  outside(path, folder) {
    const inner = normal(path);
    return inner.startsWith(`files/${folder}`) ? this.known.get(inner.slice(`files/${folder}`.length)) : undefined;
  }

  // Adds a file of the built-in examples.
  addExample(path, bytes) {
    put(this.examples, path, bytes);
    this.share(`/examples/${path}`, bytes);
  }

  // Passes a file on to the workers.
  share(path, bytes) {
    this.shared.set(path, bytes);
    this.changed(path, bytes);
  }

  // Takes a file that another instance shares.
  take(path, bytes) {
    const [, folder, rest] = path.match(/^\/(files|examples)\/(.*)$/);
    if (folder === "examples") {
      put(this.examples, rest, bytes);
    } else {
      this.known.set(rest, put(this.user, rest, bytes).data);
    }
  }

  // Takes a file that another instance has written, as if the editor had.
  takeWritten(path, bytes) {
    put(this.user, path, bytes);
  }

  // Returns the files that the editor has written since the last call: their paths and bytes.
  written() {
    const found = [];
    const visit = (folder, path) => {
      for (const [name, entry] of folder.contents) {
        const full = path + name;
        if (entry instanceof Directory) {
          visit(entry, `${full}/`);
        } else if (this.known.get(full) !== entry.data && !name.startsWith(".") && !name.endsWith("~")) {
          this.known.set(full, entry.data);
          this.share(`/files/${full}`, entry.data);
          found.push([full, entry.data]);
        }
      }
    };
    visit(this.user, "");
    return found;
  }

  // Reads /own from the last visit.
  async restore() {
    try {
      this.database = await new Promise((resolve, reject) => {
        const request = indexedDB.open(DATABASE, 2);
        request.onupgradeneeded = () => {
          for (const name of [STORE, USER]) {
            if (!request.result.objectStoreNames.contains(name)) {
              request.result.createObjectStore(name);
            }
          }
        };
        // Another tab has the former version.
        request.onblocked = () => reject(new Error("another tab uses them"));
        request.onsuccess = () => resolve(request.result);
        request.onerror = () => reject(request.error);
      });
      const store = this.database.transaction(STORE).objectStore(STORE);
      const all = Object.entries((await answer(store.get(STORE))) ?? {});
      const isWork = ([path]) => path.startsWith("state/");
      if (!(await isOnlyTab())) {
        // Another tab keeps its work; this one gets the preferences alone, and keeps nothing.
        this.database = null;
        this.tell("Marraztu is open in another tab, so unsaved work of this tab is not kept for the next visit");
      }
      for (const [path, bytes] of all.filter((file) => this.database || !isWork(file))) {
        put(this.own, path, bytes);
      }
      if (this.database) {
        await this.restoreUser(all.some(([path]) => /^state\/.*\.marraztu$/.test(path)));
      }
    } catch (error) {
      // A private window may have no database; the editor works without.
      console.warn("Preferences and unsaved work are not kept:", error);
      this.database = null;
      this.tell("This browser keeps no files, so unsaved work is not kept for the next visit");
    }
    this.kept = new Map(this.list());
  }

  // Reads the user's files if there is work that needs them, or else forgets them.
  async restoreUser(isNeeded) {
    const store = this.store(USER);
    if (!isNeeded) {
      await answer(store.clear());
      return;
    }
    const [paths, contents] = await Promise.all([answer(store.getAllKeys()), answer(store.getAll())]);
    for (const [index, path] of paths.entries()) {
      this.add(path, contents[index]);
    }
  }

  list() {
    const found = [];
    const visit = (folder, path) => {
      for (const [name, entry] of folder.contents) {
        if (entry instanceof Directory) {
          visit(entry, `${path}${name}/`);
        } else {
          found.push([path + name, entry.data]);
        }
      }
    };
    visit(this.own, "");
    return found;
  }

  // Keeps /own for the next visit, if it has changed. A written file has another array of bytes.
  keep() {
    const list = this.list();
    const isKept = ([path, bytes]) => this.kept.get(path) === bytes;
    if (!this.database || (list.length === this.kept.size && list.every(isKept))) {
      return;
    }
    this.kept = new Map(list);
    const store = this.store(STORE);
    // The files are copied: the editor goes on writing.
    store?.put(Object.fromEntries(list.map(([path, bytes]) => [path, bytes.slice()])), STORE);
  }
}

// Resolves "." and ".." in a path, which gets no slash in front.
function normal(path) {
  const parts = [];
  for (const part of path.split("/")) {
    if (part === "..") {
      parts.pop();
    } else if (part && part !== ".") {
      parts.push(part);
    }
  }
  return parts.join("/");
}

function isEqual(bytes, others) {
  return bytes.length === others.length && bytes.every((byte, at) => byte === others[at]);
}

// Puts a file into folders like those of its path. Returns it.
function put(folder, path, bytes) {
  const parts = path.split("/");
  const last = parts.pop();
  for (const part of parts) {
    let next = folder.contents.get(part);
    if (!(next instanceof Directory)) {
      next = new Directory(new Map());
      folder.contents.set(part, next);
    }
    folder = next;
  }
  const file = new File(bytes);
  folder.contents.set(last, file);
  return file;
}

// Returns whether no other tab has the editor open. The answer holds until this page is closed.
function isOnlyTab() {
  if (!navigator.locks) {
    return true;
  }
  return new Promise((resolve) => {
    // After a reload, the page before keeps the lock for a moment.
    const soon = AbortSignal.timeout(1000);
    const held = navigator.locks.request(DATABASE, { signal: soon }, () => {
      resolve(true);
      return new Promise(() => {});
    });
    held.catch(() => resolve(false));
  });
}

function answer(request) {
  return new Promise((resolve, reject) => {
    request.onsuccess = () => resolve(request.result);
    request.onerror = () => reject(request.error);
  });
}
