// The files of the editor: a file system in memory, with the folder /files for the user's files and
// /own for preferences and unsaved work. IndexedDB keeps /own for the next visit.

import { Directory, File } from "./wasi/index.js";

const DATABASE = "marraztu";
const STORE = "own";

export class Files {
  constructor() {
    this.user = new Directory(new Map());
    this.own = new Directory(new Map());
    // The content of each file of the user that the page knows.
    this.known = new Map();
    this.kept = "";
    this.database = null;
  }

  // The root folder, for WASI.
  root() {
    return new Map([["files", this.user], ["own", this.own]]);
  }

  // Adds a file of the user, in folders like those of its name. Returns its path.
  add(name, bytes) {
    const parts = name.split("/").filter((part) => part && part !== "." && part !== "..");
    const last = parts.pop() ?? "file";
    let folder = this.user;
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
    const path = [...parts, last].join("/");
    this.known.set(path, file.data);
    return `/files/${path}`;
  }

  // Returns whether there is a file.
  has(name) {
    return this.known.has(name);
  }

  // Returns the files that the editor has written since the last call, with their bytes.
  written() {
    const found = [];
    const visit = (folder, path) => {
      for (const [name, entry] of folder.contents) {
        const full = path + name;
        if (entry instanceof Directory) {
          visit(entry, `${full}/`);
        } else if (this.known.get(full) !== entry.data && !name.startsWith(".")) {
          this.known.set(full, entry.data);
          found.push([name, entry.data]);
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
        const request = indexedDB.open(DATABASE, 1);
        request.onupgradeneeded = () => request.result.createObjectStore(STORE);
        request.onsuccess = () => resolve(request.result);
        request.onerror = () => reject(request.error);
      });
      const store = this.database.transaction(STORE).objectStore(STORE);
      const all = await answer(store.get(STORE));
      for (const [path, bytes] of Object.entries(all ?? {})) {
        this.put(path, bytes);
      }
    } catch (error) {
      // A private window may have no database; the editor works without.
      console.warn("Preferences and unsaved work are not kept:", error);
    }
    this.kept = this.state();
  }

  put(path, bytes) {
    const parts = path.split("/");
    const last = parts.pop();
    let folder = this.own;
    for (const part of parts) {
      if (!folder.contents.has(part)) {
        folder.contents.set(part, new Directory(new Map()));
      }
      folder = folder.contents.get(part);
    }
    folder.contents.set(last, new File(bytes));
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

  // Describes the content of /own; another content has another description.
  state() {
    const hash = (bytes) => bytes.reduce((sum, byte) => (Math.imul(sum, 31) + byte) | 0, 7);
    return this.list().map(([path, bytes]) => `${path} ${bytes.length} ${hash(bytes)}`).join("\n");
  }

  // Keeps /own for the next visit, if it has changed.
  keep() {
    const state = this.state();
    if (!this.database || state === this.kept) {
      return;
    }
    this.kept = state;
    const store = this.database.transaction(STORE, "readwrite").objectStore(STORE);
    // The files are copied: the editor goes on writing.
    store.put(Object.fromEntries(this.list().map(([path, bytes]) => [path, bytes.slice()])), STORE);
  }
}

function answer(request) {
  return new Promise((resolve, reject) => {
    request.onsuccess = () => resolve(request.result);
    request.onerror = () => reject(request.error);
  });
}
