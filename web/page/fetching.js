// Fetches models and scenes, and the files that they refer to, into the file system of the editor.

const FILES = "/files";
const EXAMPLE = "example:/";

async function bytes(place) {
  const response = await fetch(place);
  if (!response.ok) {
    throw new Error(`${place}: ${response.status} ${response.statusText}`);
  }
  return new Uint8Array(await response.arrayBuffer());
}

export class Fetching {
  // `missing` returns the files that the file at a path refers to and that do not exist: for each
  // one, the paths at which it may be.
  constructor(files, missing) {
    this.files = files;
    this.missing = missing;
  }

  // Fetches a model or a scene with its files. Returns its path.
  async model(url) {
    const base = new URL(url, location.href);
    // The files keep their folders, so that "../" between them works.
    const path = this.files.add(decodeURIComponent(base.pathname).replace(/\/$/, "/model.obj"), await bytes(base));
    // Names of files may hold "#", "?" and "%".
    const place = (path) => new URL(path.slice(FILES.length).split("/").map(encodeURIComponent).join("/"), base);
    await this.others(path, (other) => other.startsWith(`${FILES}/`) && place(other));
    return path;
  }

  // Fetches the files of the built-in examples that a scene refers to.
  async examples(path) {
    await this.others(path, () => null);
  }

  // Fetches the files that a file refers to. `place` returns the address of a path, if it has one.
  async others(path, place) {
    const tried = new Set();
    // A scene refers to models, a model to MTL files, and those to textures.
    for (let round = 0; round < 4; round++) {
      const wanted = this.missing(path).map((paths) => paths.filter((path) => !tried.has(path)));
      wanted.flat().forEach((path) => tried.add(path));
      const all = await Promise.all(wanted.map((paths) => this.first(paths, place)));
      if (!all.includes(true)) {
        break;
      }
    }
  }

  // Fetches the file at the first of these paths that has one. Returns whether there was a file. The
  // editor reports the others.
  async first(paths, place) {
    for (const path of paths) {
      const isExample = path.startsWith(EXAMPLE);
      const address = isExample ? `examples/${path.slice(EXAMPLE.length)}` : place(path);
      if (!address) {
        continue;
      }
      const found = await bytes(address).catch(() => null);
      if (!found) {
        continue;
      }
      if (isExample) {
        this.files.addExample(path.slice(EXAMPLE.length), found);
      } else {
        // The address has no "../".
        this.files.add(decodeURIComponent(address.pathname), found);
      }
      return true;
    }
    return false;
  }
}
