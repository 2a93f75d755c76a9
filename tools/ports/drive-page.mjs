// Drives the page of `tools/ports/web` in Chromium, as a user would: node drive-page.mjs FOLDER [WORD]
//
// The checks see what a user sees or gets: pixels, messages (the page has them as text, for screen
// readers) and downloaded scenes. WORD chooses the checks that have it in their names. KEEP=FOLDER
// writes a picture of each page at its end.
import { mkdir, mkdtemp, readFile, rm, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { Browser, serve, sleep } from "./browser.mjs";

const [folder, word = ""] = process.argv.slice(2);

// A page with the editor.
class Page {
  constructor(tab) {
    this.tab = tab;
  }

  // Opens an address, and waits until the editor has started.
  async open(address) {
    await this.tab.open(address);
    await this.started();
  }

  async started() {
    await this.until("the editor starts", async () => (await this.status()) === "");
  }

  status() {
    return this.tab.run(() => document.getElementById("status").textContent);
  }

  said() {
    return this.tab.run(() => document.getElementById("said").textContent);
  }

  // Waits until something holds, and returns it.
  async until(what, holds, seconds = 30) {
    const end = Date.now() + 1000 * seconds;
    while (Date.now() < end) {
      const found = await holds();
      if (found) {
        return found;
      }
      await sleep(50);
    }
    throw new Error(`in ${seconds} s, this never was so: ${what}; it says: ${await this.said()}`);
  }

  // Waits until the editor says something.
  hears(text, seconds) {
    return this.until(`it says "${text}"`, async () => (await this.said()).includes(text), seconds);
  }

  // Finds all pixels with much of these colours and little of the others. Returns the place of the one in
  // the middle, in reading order, and the mean of their columns.
  find(colors) {
    return this.tab.run((colors) => {
      const canvas = document.getElementById("canvas");
      const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d");
      copy.drawImage(canvas, 0, 0);
      const { data } = copy.getImageData(0, 0, canvas.width, canvas.height);
      const parts = ["red", "green", "blue"].map((name) => colors.includes(name));
      const places = [];
      for (let at = 0; at < data.length / 4; at++) {
        // The properties at the right have colours, too.
        const isPicture = at % canvas.width < 0.73 * canvas.width;
        if (isPicture && parts.every((wanted, part) => (wanted ? data[4 * at + part] > 90 : data[4 * at + part] < 50))) {
          places.push([at % canvas.width, Math.floor(at / canvas.width)]);
        }
      }
      if (places.length < 50) {
        return null;
      }
      const mean = places.reduce((sum, place) => sum + place[0], 0) / places.length;
      const [x, y] = places[places.length >> 1];
      return [x, y, mean].map((length) => (length + 0.5) / window.devicePixelRatio);
    }, colors);
  }

  sees(...colors) {
    return this.until(`something ${colors.join(" and ")} is shown`, () => this.find(colors));
  }

  // Returns how far the background of the first scene reaches to the right and down, in CSS pixels.
  reach() {
    return this.tab.run(() => {
      const canvas = document.getElementById("canvas");
      const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d");
      copy.drawImage(canvas, 0, 0);
      const pixels = new Uint32Array(copy.getImageData(0, 0, canvas.width, canvas.height).data.buffer);
      let [right, down] = [0, 0];
      for (let at = pixels.indexOf(0xffb30000); at >= 0; at = pixels.indexOf(0xffb30000, at + 1)) {
        right = Math.max(right, (at % canvas.width) + 1);
        down = Math.floor(at / canvas.width) + 1;
      }
      return [right, down].map((count) => count / window.devicePixelRatio);
    });
  }

  // Returns a number for the pixels of the canvas, or of an area of it.
  pixels(area) {
    return this.tab.run(async (area) => {
      const canvas = document.getElementById("canvas");
      const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d");
      copy.drawImage(canvas, 0, 0);
      const { data } = copy.getImageData(...(area ?? [0, 0, canvas.width, canvas.height]));
      return Array.from(new Uint8Array(await crypto.subtle.digest("SHA-256", data))).join(" ");
    }, area);
  }

  // Waits until the picture is refined. Returns its number.
  async still(area) {
    return this.until("the picture is still for 3 seconds", async () => {
      const before = await this.pixels(area);
      await sleep(3000);
      return (await this.pixels(area)) === before && before;
    });
  }

  // Does something that changes the picture.
  async changes(what, act) {
    const before = await this.pixels();
    await act();
    await this.until(`${what} changes the picture`, async () => (await this.pixels()) !== before);
  }

  // Saves the scene, which is downloaded. Returns its text.
  async scene() {
    const [name, bytes] = await this.tab.download(() => this.tab.press("Control+s"));
    equal(name, "scene.marraztu", "the name of the download");
    await this.hears("Downloaded scene.marraztu");
    return bytes.toString();
  }

  // Chooses the best match in the palette.
  async palette(words) {
    await this.tab.press("Control+k");
    await this.tab.type(words);
    await sleep(300);
    await this.tab.press("Enter");
  }
}

function equal(found, wanted, what) {
  if (found !== wanted) {
    throw new Error(`${what}: ${found}, not ${wanted}`);
  }
}

function has(text, wanted, what) {
  if (!text.includes(wanted)) {
    throw new Error(`${what} lacks "${wanted}":\n${text}`);
  }
}

// Returns the place of an object in a scene file along x.
const x = (scene, name) => Number(scene.split(`name: "${name}"`)[1]?.match(/placement: .*\((\S+), \S+, \S+, 1.0\)\)/)?.[1]);

// A PNG of 2 x 2 pixels in magenta.
const PNG = "iVBORw0KGgoAAAANSUhEUgAAAAIAAAACCAIAAAD91JpzAAAAEElEQVR42mP4z/AfiBggFAA31gf5htMR8gAAAABJRU5ErkJggg==";

// A square that glows in the colour of a texture. The texture and the MTL file are in a folder below.
async function writeModels(at) {
  await mkdir(join(at, "looks"), { recursive: true });
  await writeFile(join(at, "square.obj"), `mtllib looks/square.mtl
v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1
usemtl glow\nf 1/1/1 2/2/1 3/3/1 4/4/1\n`);
  await writeFile(join(at, "looks/square.mtl"), "newmtl glow\nKa 0 0 0\nKd 0 0 0\nKs 0 0 0\nKe 1 1 1\nmap_Ke glow.png\n");
  await writeFile(join(at, "looks/glow.png"), Buffer.from(PNG, "base64"));
}

// A scene of this square and of a green one, to the right of it.
async function writeScene(at) {
  await mkdir(join(at, "parts"), { recursive: true });
  await writeFile(join(at, "parts/green.obj"), `mtllib green.mtl
v 2 -1 0\nv 4 -1 0\nv 4 1 0\nv 2 1 0\nvn 0 0 1\nusemtl glow\nf 1//1 2//1 3//1 4//1\n`);
  await writeFile(join(at, "parts/green.mtl"), "newmtl glow\nKa 0 0 0\nKd 0 0 0\nKs 0 0 0\nKe 0 1 0\n");
  await writeFile(join(at, "both.marraztu"), `(version: 1, cameras: [(id: 3, name: "camera", eye: (0.0, 0.0, 9.0))], objects: [
    (id: 1, name: "square", model: File(path: "../models/square.obj"), material: File),
    (id: 2, name: "green", model: File(path: "parts/green.obj"), material: File)])`);
  await writeFile(join(at, "broken.obj"), "<!doctype html>\n<title>Sign in</title>\n");
  await writeFile(join(at, "broken.marraztu"), "(version: 1, objects: [");
}

// A large red square and a small blue one in front of it, with equal names of all files.
async function writeNamesakes(at) {
  for (const [name, size, depth, color] of [["large", 3, -1, "1 0 0"], ["small", 1, 0, "0 0 1"]]) {
    await mkdir(join(at, name), { recursive: true });
    const corners = [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([x, y]) => `v ${size * x} ${size * y} ${depth}`).join("\n");
    await writeFile(join(at, name, "model.obj"), `mtllib material.mtl\n${corners}\nvn 0 0 1\nusemtl glow\nf 1//1 2//1 3//1 4//1\n`);
    await writeFile(join(at, name, "material.mtl"), `newmtl glow\nKa 0 0 0\nKd 0 0 0\nKs 0 0 0\nKe ${color}\n`);
  }
}

const files = await mkdtemp(join(tmpdir(), "marraztu-models-"));
await writeModels(join(files, "models"));
await writeScene(join(files, "scenes"));
await writeNamesakes(files);
const served = await serve({ "": folder, models: join(files, "models"), scenes: join(files, "scenes") });
// Another origin, with the example of docs/web.md for a page that embeds a picture.
const manual = await readFile(new URL("../../docs/web.md", import.meta.url), "utf8");
const example = manual.match(/```html\n(.*?)```/s)[1].replaceAll("http://localhost:8000/", served.address);
await writeFile(join(files, "index.html"), `<!doctype html>${example.replace("models/teapot.obj", "/models/square.obj")}`);
const other = await serve({ "": files });
const site = served.address;

const checks = {
  async "the first scene is shown; a click selects, a key moves, undo undoes, a save is downloaded, and then it rests"(visit) {
    const page = await visit();
    await page.open(site);
    await page.sees("red");
    const [column, row] = await page.sees("green");
    await page.tab.click(column, row);
    // Another thread may find the object under the pointer.
    await page.until("the object is selected", async () => /subject: Object,\s*object: Some\(1\)/.test(await page.scene()));
    await page.changes("a step of an object", () => page.tab.press("x"));
    const scene = await page.scene();
    equal(x(scene, "x_wing"), 110, "the clicked object after a step");
    equal(x(scene, "r_falke"), -100, "the other object");
    await page.tab.press("Control+z");
    await page.hears("Undone");
    equal(x(await page.scene(), "x_wing"), 100, "the object after undo");
    const frames = () => page.tab.run(() => window.framesAsked);
    // A notice goes after some seconds, and a picture is refined.
    await page.until("no frame for 3 seconds", async () => {
      const before = await frames();
      await sleep(3000);
      return (await frames()) === before;
    }, 40);
  },

  async "another size and another scale of the screen are followed"(visit) {
    const page = await visit();
    await page.open(site);
    const size = () => page.tab.run(() => [canvas.width, canvas.height].join("x"));
    equal(await size(), "1000x640", "the canvas");
    await page.tab.resize(390, 844);
    await page.until("the canvas is narrow", async () => (await size()) === "390x844");
    await page.tab.resize(390, 844, 2);
    await page.tab.mouse("mouseMoved", 100, 300);
    await page.until("the canvas is twice as fine", async () => (await size()) === "780x1688");
    await page.sees("red");
  },

  async "the picture fills a phone with three pixels per point, and a 4K screen"(visit) {
    const page = await visit();
    for (const [width, height, scale] of [[390, 844, 3], [844, 390, 3], [3840, 2160, 1]]) {
      await page.tab.resize(width, height, scale);
      await page.open(`${site}view.html`);
      await page.until(`the picture fills ${width}x${height} at ${scale}`, async () => {
        const [right, down] = await page.reach();
        return right === width && down === height;
      }, 60);
      await page.open(site);
      // The status line is below it.
      await page.until(`the picture reaches the lower end of ${height}`, async () => (await page.reach())[1] > height - 40, 60);
    }
  },

  async "the browser asks before unsaved work is left, and not after it was saved"(visit) {
    const page = await visit();
    await page.open(site);
    await page.sees("red");
    await page.tab.press("c");
    await page.changes("a step", () => page.tab.press("x"));
    page.tab.leaves = false;
    page.tab.send("Page.reload").catch(() => {});
    await page.until("the browser asks", () => page.tab.asked > 0);
    equal(x(await page.scene(), "r_falke"), -90, "the object in the page that was not left");
    page.tab.leaves = true;
    await page.tab.reload();
    await page.started();
    equal(page.tab.asked, 1, "questions");
  },

  async "a second tab says that its unsaved work is not kept, also if it opens a model"(visit, visitor) {
    const first = await visit();
    await first.open(site);
    await first.sees("red");
    for (const search of ["", "?model=/models/square.obj"]) {
      const second = await visit(visitor);
      await second.open(site + search);
      await second.hears("Marraztu is open in another tab");
    }
    equal((await first.said()).includes("another tab"), false, "the first tab says so, too");
  },

  async "unsaved work is offered after a reload and after a crash"(visit, visitor) {
    let page = await visit();
    await page.open(site);
    await page.sees("red");
    // The keys act on objects, not on cameras.
    await page.tab.press("c");
    await page.changes("a step", () => page.tab.press("x"));
    await sleep(1500);
    await page.tab.reload();
    await page.started();
    await page.hears("The program ended with unsaved changes to a new scene");
    await page.tab.press("Control+Shift+R");
    await page.hears("Recovered unsaved changes");
    await page.changes("another step", () => page.tab.press("x"));
    await sleep(1500);
    await page.tab.crash();
    page = await visit(visitor);
    await page.open(site);
    await page.hears("The program ended with unsaved changes to a new scene");
    await page.tab.press("Control+Shift+R");
    await page.hears("Recovered unsaved changes");
    equal(x(await page.scene(), "r_falke"), -80, "the recovered object after two steps");
  },

  async "a link opens a model with its MTL file and texture"(visit) {
    const page = await visit();
    await page.open(`${site}?model=/models/square.obj`);
    await page.hears("Opened square");
    await page.sees("red", "blue");
    await page.open(`${site}?model=/models/none.obj`);
    await page.hears("models/none.obj: the server answers 404");
    await page.sees("red");
  },

  async "a link opens a scene with the files of all its models"(visit) {
    const page = await visit();
    await page.open(`${site}?model=/scenes/both.marraztu`);
    await page.hears("Opened both.marraztu");
    await page.sees("red", "blue");
    await page.sees("green");
  },

  async "a picture is saved"(visit) {
    const page = await visit();
    await page.open(site);
    await page.sees("red");
    const [name, bytes] = await page.tab.download(() => page.palette("save picture"));
    equal(name, "picture.png", "the name of the picture");
    equal(bytes.subarray(1, 4).toString(), "PNG", "its format");
    equal(bytes.readUInt32BE(16) > 500, true, "it is as wide as the viewport");
  },

  async "a turntable is drawn while the page answers"(visit) {
    const page = await visit();
    await page.open(`${site}?model=/scenes/both.marraztu`);
    await page.sees("green");
    const turntable = async () => {
      await page.palette("turntable");
      await sleep(300);
      await page.tab.press("Enter");
    };
    await page.tab.run(() => {
      window.longest = 0;
      let last = performance.now();
      const watch = (now) => {
        window.longest = Math.max(window.longest, now - last);
        last = now;
        requestAnimationFrame(watch);
      };
      requestAnimationFrame(watch);
    });
    const begun = Date.now();
    const [name, bytes] = await page.tab.download(turntable);
    const spent = Date.now() - begun;
    equal(name, "turntable.gif", "the name of the turntable");
    equal(bytes.subarray(0, 6).toString(), "GIF89a", "its format");
    await page.hears("Downloaded turntable.gif");
    const longest = await page.tab.run(() => window.longest);
    console.log(`  the turntable took ${spent} ms, and the longest frame meanwhile ${Math.round(longest)} ms`);
    equal(longest < spent / 2, true, `the page answers: ${longest} ms of ${spent} without a frame`);
  },

  async "a dropped folder opens its model with MTL file and texture"(visit) {
    const page = await visit();
    await page.open(site);
    await page.sees("red");
    await page.tab.drop(500, 200, [join(files, "models")]);
    await page.hears("Opened square");
    await page.sees("red", "blue");
  },

  async "the file dialog loads a model with MTL file and texture"(visit) {
    const page = await visit();
    await page.open(site);
    await page.sees("red");
    const chosen = ["square.obj", "looks/square.mtl", "looks/glow.png"].map((name) => join(files, "models", name));
    await page.tab.choose(chosen, () => page.tab.press("f"));
    await page.until("the material is asked for", async () => {
      // The dialog says nothing, so its answer is tried.
      await page.tab.press("Enter");
      await sleep(300);
      return (await page.said()).includes("Opened square");
    });
    has(await page.scene(), 'path: "square.obj"', "the scene");
    // The square is small and far away.
    await page.tab.press(".");
    await page.sees("red", "blue");
  },

  async "an object is copied once and pasted twice while Ctrl is down"(visit) {
    const page = await visit();
    await page.open(site);
    await page.sees("red");
    // The keys act on objects, not on cameras.
    await page.tab.press("c");
    await page.tab.press("Control+c");
    await page.hears("Copied r_falke");
    await page.tab.press("Control+v", 2);
    await page.hears("Pasted r_falke");
    await page.still();
    const copies = (await page.scene()).match(/name: "r_falke \d+"/g).toSorted().join(", ");
    equal(copies, 'name: "r_falke 2", name: "r_falke 3"', "the copies");
  },

  async "files of equal names keep to their own models"(visit) {
    const page = await visit();
    await page.open(site);
    const drop = (name) => page.tab.drop(500, 200, ["model.obj", "material.mtl"].map((file) => join(files, name, file)));
    await drop("large");
    await page.hears("Opened model");
    await page.sees("red");
    await drop("small");
    await page.until("the material is asked for, and both are shown", async () => {
      await page.tab.press("Enter");
      await sleep(300);
      return (await page.find(["blue"])) && (await page.find(["red"]));
    });
    const scene = await page.scene();
    has(scene, 'path: "model.obj"', "the scene");
    has(scene, 'path: "2/model.obj"', "the scene");
  },

  async "an example is fetched, also for unsaved work"(visit) {
    const page = await visit();
    await page.open(site);
    await page.sees("red");
    await page.palette("example chess");
    await page.hears("Opened chess");
    await page.changes("a step", () => page.tab.press("x"));
    // The part of the picture left of the notices and below the dial, whose sentence may take
    // another line.
    const board = [240, 260, 270, 330];
    const before = await page.still(board);
    // Boxes for missing files would hide others.
    equal((await page.said()).includes("it is behind other objects"), false, "an object is hidden");
    await page.tab.reload();
    await page.started();
    await page.hears("The program ended with unsaved changes");
    await page.tab.press("Control+Shift+R");
    await page.hears("Recovered unsaved changes");
    equal(await page.still(board), before, "the picture of the recovered scene");
  },

  async "a lesson opens, and the laboratory measures and gives its verdict"(visit) {
    const page = await visit(undefined, 700, 560);
    await page.open(site);
    await page.palette("why surfaces show through each other");
    const cost = await page.until("the lesson quotes a figure", async () => {
      const said = await page.said();
      return /\d/.test(said) && said;
    }, 100);
    await page.tab.press("F5");
    await page.until("a verdict", async () => (await page.said()).length > cost.length + 40);
  },

  async "all pictures are as listed"(visit) {
    const page = await visit();
    await page.tab.open(`${site}?verify`);
    const [, right, all] = await page.until("a result", async () => (await page.status()).match(/(\d+) of (\d+) pictures/), 120);
    equal(right, all, "pictures as listed");
    if (all < 54) {
      throw new Error(`only ${all} pictures were drawn`);
    }
  },

  async "the viewer shows only the picture, and turns it by pointer, touch and wheel"(visit) {
    const page = await visit(undefined, 400, 300);
    await page.open(`${site}view.html?model=/models/square.obj&view=front`);
    const [, , middle] = await page.sees("red", "blue");
    equal(Math.round(middle / 4), 50, "a quarter of the middle of the square");
    await page.still();
    await page.changes("a drag", () => page.tab.drag([200, 150], [260, 170]));
    await page.still();
    await page.changes("the wheel", () => page.tab.mouse("mouseWheel", 200, 150, { deltaX: 0, deltaY: 120 }));
    await page.still();
    await page.changes("a finger", async () => {
      await page.tab.touch("touchStart", [200, 150]);
      for (let step = 1; step < 10; step++) {
        await page.tab.touch("touchMove", [200 - 8 * step, 150]);
      }
      await page.tab.touch("touchEnd");
    });
    const before = await page.still();
    await page.tab.press("x");
    await page.tab.press("Delete");
    equal(await page.still(), before, "the picture after keys, which have no effect");
    const link = await page.tab.run(() => document.getElementById("open").href);
    await page.open(link);
    await page.hears("Opened square");
  },

  async "the viewer says in a sentence why there is no picture, and shows nothing else"(visit) {
    const page = await visit(undefined, 300, 200);
    const reasons = {
      "model=/models/none.obj": "none.obj: the server answers 404",
      "model=/scenes/broken.obj": "scenes/broken.obj: this is not an OBJ file",
      "model=/scenes/broken.marraztu": "the file ends too early",
      "model=http://localhost:1/square.obj": "the server does not answer",
      "model=/models/square.obj&view=sideways": "write degrees to the right and up",
    };
    for (const [search, reason] of Object.entries(reasons)) {
      await page.tab.open(`${site}view.html?${search}`);
      await page.until(`the page says "${reason}"`, async () => (await page.status()).includes(reason));
      await keep(`viewer-${search}`, page);
      const [picture, isWhole] = await page.tab.run(() => {
        const status = document.getElementById("status");
        return [getComputedStyle(canvas).display, status.scrollHeight <= status.clientHeight];
      });
      equal(picture, "none", `the picture of ${search}`);
      equal(isWhole, true, `all of the sentence is shown: ${await page.status()}`);
      equal((await page.tab.shown(4, 4)).join(), "27,27,27", "the colour of the page");
    }
  },

  async "the viewer works in a page of another origin"(visit) {
    const page = await visit(undefined, 600, 400);
    await page.tab.open(other.address);
    await page.until("the square is in the frame", async () => {
      const [r, g, b] = await page.tab.shown(240, 180);
      return r > 200 && g < 60 && b > 200;
    });
    const active = await page.tab.run(() => document.activeElement.tagName);
    equal(active, "BODY", "the focus of the page around it");
  },
};

const browser = await Browser.start();

// Writes a picture of a page, if pictures are kept.
async function keep(name, page) {
  if (process.env.KEEP) {
    const file = `${name.replaceAll(/\W+/g, "-").slice(0, 40)}.png`;
    await writeFile(join(process.env.KEEP, file), await page.tab.picture());
  }
}

// Does a check in a profile of its own. Returns the reason why it failed, if it did.
async function reason(name, check) {
  const visitor = await browser.visitor();
  const pages = [];
  const visit = async (as = visitor, width = 1000, height = 640) => {
    pages.push(new Page(await browser.tab(as, width, height)));
    return pages.at(-1);
  };
  try {
    const late = sleep(150_000).then(() => Promise.reject(new Error("it takes longer than 150 seconds")));
    await Promise.race([check(visit, visitor), late]);
    const faults = pages.flatMap((page) => page.tab.faults);
    return faults.length > 0 ? faults.join("\n") : undefined;
  } catch (error) {
    return error.message;
  } finally {
    await keep(name, pages.at(-1));
    await browser.send("Target.disposeBrowserContext", { browserContextId: visitor });
  }
}

let failed = 0;
for (const [name, check] of Object.entries(checks).filter(([name]) => name.includes(word))) {
  const begun = Date.now();
  let why = await reason(name, check);
  if (why !== undefined) {
    // Other programs may have stopped the browser for seconds; a fault fails twice.
    console.error(`once more, because ${name} failed: ${why}`);
    why = await reason(name, check);
  }
  const seconds = ((Date.now() - begun) / 1000).toFixed(1);
  console.log(`${why === undefined ? "ok" : "FAILED"}: ${name} (${seconds} s)`);
  if (why !== undefined) {
    failed += 1;
    console.error(why);
  }
}
await browser.close();
served.close();
other.close();
await rm(files, { recursive: true });
process.exit(failed > 0 ? 1 : 0);
