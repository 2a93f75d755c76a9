// Fingers as a mouse: one finger drags with the left button, and a long touch is a click with the
// right one. Two fingers pan with the middle button or zoom, whichever they do first.

// CSS pixels that a resting finger may stray, and the milliseconds of a long touch.
const STRAY = 8;
const LONG = 500;

export class Touches {
  constructor(hear) {
    this.hear = hear;
    // The places of the fingers on the canvas.
    this.fingers = new Map();
    // "waits": one finger that may become any of the others; "drags": a button is pressed;
    // "chooses": two fingers that have not moved; "zooms"; "rests": until all fingers are gone.
    this.state = "rests";
    this.button = 0;
    this.begun = { x: 0, y: 0 };
    this.span = 0;
    this.timer = 0;
  }

  down(event) {
    const last = this.center();
    this.fingers.set(event.pointerId, { x: event.offsetX, y: event.offsetY });
    clearTimeout(this.timer);
    if (this.fingers.size === 1) {
      this.state = "waits";
      this.begun = this.center();
      this.moved(this.begun);
      this.timer = setTimeout(() => this.hold(), LONG);
      return;
    }
    // A drag ends where it was, so that the next finger does not move it.
    this.release(last);
    this.state = this.fingers.size === 2 ? "chooses" : "rests";
    if (this.state === "chooses") {
      this.begun = this.center();
      this.span = this.spread();
      this.moved(this.begun);
    }
  }

  move(event) {
    const finger = this.fingers.get(event.pointerId);
    if (!finger) {
      return;
    }
    finger.x = event.offsetX;
    finger.y = event.offsetY;
    const at = this.center();
    const way = Math.hypot(at.x - this.begun.x, at.y - this.begun.y);
    if (this.state === "waits" && way > STRAY) {
      clearTimeout(this.timer);
      this.press(this.begun, 0);
    } else if (this.state === "chooses") {
      if (Math.abs(this.spread() - this.span) > 2 * STRAY) {
        this.state = "zooms";
        this.span = this.spread();
      } else if (way > STRAY) {
        this.press(this.begun, 1);
      }
    }
    if (this.state === "drags") {
      this.moved(at);
    } else if (this.state === "zooms") {
      const span = this.spread();
      if (this.span > 0 && span > 0) {
        this.hear({ kind: "zoom", factor: span / this.span });
      }
      this.span = span;
    }
  }

  up(event) {
    const at = this.center();
    if (!this.fingers.delete(event.pointerId)) {
      return;
    }
    clearTimeout(this.timer);
    if (this.state === "waits" && event.type !== "pointercancel") {
      this.press(at, 0);
    }
    this.release(at);
    // A finger that is left does nothing: the others do not leave at the same time.
    this.state = "rests";
    if (this.fingers.size === 0) {
      // A finger that is gone hovers nowhere.
      this.hear({ kind: "gone" });
    }
  }

  // One finger has rested for long.
  hold() {
    if (this.state === "waits") {
      this.press(this.begun, 2);
      this.release(this.begun);
      this.state = "rests";
    }
  }

  moved(at) {
    this.hear({ kind: "moved", ...at, modifiers: 0 });
  }

  press(at, button) {
    this.state = "drags";
    this.button = button;
    this.hear({ kind: "button", ...at, button, pressed: true, modifiers: 0 });
  }

  release(at) {
    if (this.state === "drags") {
      this.hear({ kind: "button", ...at, button: this.button, pressed: false, modifiers: 0 });
    }
  }

  center() {
    const all = [...this.fingers.values()];
    const sum = all.reduce((a, b) => ({ x: a.x + b.x, y: a.y + b.y }), { x: 0, y: 0 });
    return { x: sum.x / all.length, y: sum.y / all.length };
  }

  spread() {
    const [a, b] = [...this.fingers.values()];
    return Math.hypot(a.x - b.x, a.y - b.y);
  }
}
