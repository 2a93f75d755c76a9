//! The editor in an array of pixels, as in a page of a browser.

use egui::{Event, Key, Modifiers, PointerButton, pos2};
use marraztu::app::{CanvasShell, Painted};

const SIZE: [usize; 2] = [900, 600];

/// A shell with a simulated clock, which advances to the next frame that is due.
struct Page {
    shell: CanvasShell,
    time: f64,
}

impl Page {
    fn open() -> Self {
        let shell = CanvasShell::new(SIZE, 1.0, Vec::new()).expect("there are threads");
        let mut page = Self { shell, time: 0.0 };
        page.rest();
        page
    }

    /// Runs frames until none is due. In every frame, all changes have to be within the reported
    /// areas.
    fn rest(&mut self) -> Vec<Painted> {
        let mut frames = Vec::new();
        for _ in 0..2000 {
            let before = self.shell.pixels().to_vec();
            let painted = self.shell.frame(self.time);
            self.assert_changes_are_reported(&before, &painted);
            frames.push(painted);
            match self.shell.due() {
                // Pictures are drawn on a thread here, which wakes the editor.
                None => std::thread::sleep(std::time::Duration::from_millis(100)),
                Some(due) => {
                    self.time += due.as_secs_f64().clamp(0.001, 0.1);
                    std::thread::sleep(due.min(std::time::Duration::from_millis(20)));
                    continue;
                }
            }
            if self.shell.due().is_none() {
                return frames;
            }
        }
        panic!("the editor never rests");
    }

    fn assert_changes_are_reported(&self, before: &[u32], painted: &Painted) {
        for (at, (old, new)) in before.iter().zip(self.shell.pixels()).enumerate() {
            if old != new {
                let place = [at % SIZE[0], at / SIZE[0]];
                let [x, y] = place.map(|at| i32::try_from(at).expect("the canvas is small"));
                let is_in = painted.changed.iter().any(|area| {
                    (area.left..area.right).contains(&x) && (area.top..area.bottom).contains(&y)
                });
                assert!(is_in, "the pixel {x}, {y} has changed unreported");
            }
        }
    }

    fn press(&mut self, key: Key, text: &str) -> Vec<Painted> {
        let modifiers = Modifiers::NONE;
        for pressed in [true, false] {
            let physical_key = None;
            self.shell.hear(Event::Key { key, physical_key, pressed, repeat: false, modifiers });
            if pressed {
                self.shell.hear(Event::Text(text.to_owned()));
            }
        }
        self.rest()
    }

    fn pixel(&self, x: usize, y: usize) -> u32 {
        self.shell.pixels()[y * SIZE[0] + x]
    }
}

#[test]
fn the_first_scene_appears_and_keys_and_pointer_change_it() {
    let mut page = Page::open();
    assert_eq!(page.pixel(450, 250), 0x00_00_b3, "the background of the first scene is blue");
    let before = page.shell.pixels().to_vec();
    // Dragging looks around.
    let at = |dx: f32| pos2(450.0 + dx, 250.0);
    let modifiers = Modifiers::NONE;
    let press = |pos, pressed| {
        let button = PointerButton::Primary;
        Event::PointerButton { pos, button, pressed, modifiers }
    };
    page.shell.hear(Event::PointerMoved(at(0.0)));
    page.shell.hear(press(at(0.0), true));
    page.rest();
    page.shell.hear(Event::PointerMoved(at(80.0)));
    page.rest();
    page.shell.hear(press(at(80.0), false));
    page.rest();
    let looked = page.shell.pixels().to_vec();
    assert_ne!(looked, before, "dragging looks around");
    page.press(Key::L, "l");
    assert_ne!(page.shell.pixels(), looked, "l switches the wireframe");
}
