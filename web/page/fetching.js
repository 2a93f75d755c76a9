// Fetches models and scenes, and the files that they refer to, into the file system of the editor.

const FILES = "/files";
const EXAMPLE = "example:/";

async function bytes(place) {
  // Without an answer, browsers do not say why.
  const response = await fetch(place).catch(() => {
    throw new Error(`${place}: the server does not answer, or does not allow this page to read its files`);
  });
  if (!response.ok) {
    throw new Error(`${place}: the server answers ${response.status} ${response.statusText}`.trim());
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
    // A model has no fragment, so "#" belongs to a name, as does a "%" that is no escape.
    const base = new URL(url.replaceAll("#", "%23").replace(/%(?![0-9a-f]{2})/gi, "%25"), location.href);
    // The files keep their folders, so that "../" between them works.
    const path = this.files.add(decodeURIComponent(base.pathname).replace(/\/$/, "/model.obj"), await bytes(base));
    // Names of files may hold "#", "?" and "%".
    const place = (path) => new URL(path.slice(FILES.length).split("/").map(encodeURIComponent).join("/"), base);
    await this.others(path, async (other) => other.startsWith(`${FILES}/`) && bytes(place(other)));
    return path;
  }

  // Fetches the files of the built-in examples that a scene refers to.
  async examples(path) {
    await this.others(path, async () => null);
  }

  // Adds the files that a file refers to. `find` returns the content of the file at a path, if it finds one.
  async others(path, find) {
    const tried = new Set();
    // A scene refers to models, a model to MTL files, and those to textures.
    for (let round = 0; round < 4; round++) {
      const wanted = this.missing(path).map((paths) => paths.filter((path) => !tried.has(path)));
      wanted.flat().forEach((path) => tried.add(path));
      const all = await Promise.all(wanted.map((paths) => this.first(paths, find)));
      if (!all.includes(true)) {
        break;
      }
    }
  }

  // Adds the file at the first of these paths that has one. Returns whether there was a file. The
  // editor reports the others.
  async first(paths, find) {
    for (const path of paths) {
      const isExample = path.startsWith(EXAMPLE);
      const finding = isExample ? bytes(`examples/${path.slice(EXAMPLE.length)}`) : find(path);
      const found = await finding.catch(() => null);
      if (!found) {
        continue;
      }
      if (isExample) {
        this.files.addExample(path.slice(EXAMPLE.length), found);
      } else {
        this.files.add(path.slice(FILES.length), found);
      }
      return true;
    }
    return false;
  }
}
