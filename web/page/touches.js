// Fingers as a mouse: one finger drags with the left button, two fingers pan with the middle button
// and zoom.

export class Touches {
  constructor(hear) {
    this.hear = hear;
    // The places of the fingers on the canvas.
    this.fingers = new Map();
    this.button = null;
    this.span = 0;
  }

  down(event) {
    this.fingers.set(event.pointerId, { x: event.offsetX, y: event.offsetY });
    this.change();
  }

  move(event) {
    const finger = this.fingers.get(event.pointerId);
    if (!finger) {
      return;
    }
    finger.x = event.offsetX;
    finger.y = event.offsetY;
    this.hear({ kind: "moved", ...this.center(), modifiers: 0 });
    if (this.fingers.size === 2) {
      const span = this.spread();
      if (this.span > 0 && span > 0) {
        this.hear({ kind: "zoom", factor: span / this.span });
      }
      this.span = span;
    }
  }

  up(event) {
    const at = this.center();
    if (this.fingers.delete(event.pointerId)) {
      this.change(at);
    }
  }

  // Presses the button for the number of fingers, and releases the one before.
  change(at = this.center()) {
    const button = [null, 0, 1][this.fingers.size] ?? null;
    if (this.button !== null) {
      this.hear({ kind: "button", ...at, button: this.button, pressed: false, modifiers: 0 });
    }
    this.button = button;
    this.span = this.fingers.size === 2 ? this.spread() : 0;
    if (button !== null) {
      this.hear({ kind: "button", ...this.center(), button, pressed: true, modifiers: 0 });
    } else if (this.fingers.size === 0) {
      // A finger that is gone hovers nowhere.
      this.hear({ kind: "gone" });
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
