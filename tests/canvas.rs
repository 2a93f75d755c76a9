//! The editor in an array of pixels, as in a page of a browser.

use egui::{Event, Key, Modifiers, PointerButton, pos2};
use marraztu::app::{CanvasShell, DrawingServer, Painted};

const SIZE: [usize; 2] = [900, 600];

/// A shell with a simulated clock, which advances to the next frame that is due.
struct Page {
    shell: CanvasShell,
    /// What draws the viewport, if the shell itself does not.
    server: Option<DrawingServer>,
    time: f64,
}

impl Page {
    fn open() -> Self {
        let shell = CanvasShell::new(SIZE, 1.0, Vec::new()).expect("there are threads");
        let mut page = Self { shell, server: None, time: 0.0 };
        page.rest();
        page
    }

    /// Opens a page with a server that draws its viewport.
    fn open_with_server() -> Self {
        let mut shell = CanvasShell::new(SIZE, 1.0, Vec::new()).expect("there are threads");
        shell.draw_elsewhere();
        let mut page = Self { shell, server: Some(DrawingServer::new(|| false)), time: 0.0 };
        page.rest();
        page
    }

    /// Passes messages until the server waits; returns whether it does.
    fn exchange(&mut self) -> bool {
        let Some(server) = &mut self.server else { return true };
        loop {
            if let Some(request) = self.shell.request() {
                server.hear(&request);
            }
            match server.rest() {
                None => return true,
                Some(rest) if !rest.is_zero() => return false,
                Some(_) => {}
            }
            if let Some(reply) = server.work() {
                self.shell.reply(Some(&reply));
            }
        }
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
            let waits = self.exchange();
            match self.shell.due() {
                // Pictures are drawn on a thread here, which wakes the editor.
                None => std::thread::sleep(std::time::Duration::from_millis(100)),
                Some(due) => {
                    self.time += due.as_secs_f64().clamp(0.001, 0.1);
                    std::thread::sleep(due.min(std::time::Duration::from_millis(20)));
                    continue;
                }
            }
            if self.shell.due().is_none() && waits {
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

impl Page {
    /// Returns the middle of the viewport, which no text covers.
    fn middle(&self) -> Vec<u32> {
        (150..400)
            .flat_map(|y| (300..600).map(move |x| (x, y)))
            .map(|(x, y)| self.pixel(x, y))
            .collect()
    }

    /// Returns a place on an object: the middle of five pixels that are not of the background.
    fn seen_object(&self) -> [f32; 2] {
        let is_object = |x: usize, y: usize| self.pixel(x, y) != 0x00_00_b3;
        let mut places = (150..400).flat_map(|y| (300..600).map(move |x| (x, y)));
        let found = places.find(|(x, y)| (0..5).all(|i| is_object(x + i, *y)));
        let (x, y) = found.expect("the first scene has objects");
        [x + 2, y].map(|at| f32::from(u16::try_from(at).expect("the canvas is small")))
    }

    fn click(&mut self, x: f32, y: f32) {
        let (pos, button, modifiers) = (pos2(x, y), PointerButton::Primary, Modifiers::NONE);
        self.shell.hear(Event::PointerMoved(pos));
        self.rest();
        for pressed in [true, false] {
            self.shell.hear(Event::PointerButton { pos, button, pressed, modifiers });
            self.rest();
        }
    }
}

#[test]
fn a_server_draws_the_pictures_that_the_shell_draws_itself() {
    let mut pages = [Page::open(), Page::open_with_server()];
    let mut seen = Vec::new();
    let mut compare = |pages: &[Page; 2], what: &str| {
        let [here, there] = pages.each_ref().map(Page::middle);
        assert!(here == there, "{what}");
        assert!(!seen.contains(&here), "{what} is not seen");
        seen.push(here);
    };
    compare(&pages, "the first scene");
    // A click asks which item the pixel shows, and selects it.
    let [x, y] = pages[0].seen_object();
    pages.iter_mut().for_each(|page| page.click(x, y));
    compare(&pages, "the outline of a selected object");
    pages.iter_mut().for_each(|page| drop(page.press(Key::X, "x")));
    compare(&pages, "a moved object");
    pages.iter_mut().for_each(|page| drop(page.press(Key::L, "l")));
    compare(&pages, "a wireframe");
    // A server that stops costs nothing but a picture.
    let [_, page] = &mut pages;
    page.server = Some(DrawingServer::new(|| false));
    page.shell.reply(None);
    pages.iter_mut().for_each(|page| drop(page.press(Key::L, "l")));
    pages.iter_mut().for_each(|page| drop(page.press(Key::X, "x")));
    compare(&pages, "a picture by another server");
}

#[test]
fn a_key_after_a_click_acts_on_what_was_clicked_however_late_that_is_known() {
    let mut pages = [Page::open(), Page::open_with_server()];
    let [x, y] = pages[0].seen_object();
    let [patient, hasty] = &mut pages;
    patient.click(x, y);
    patient.press(Key::X, "x");
    // The server answers only after the key.
    let (pos, button, modifiers) = (pos2(x, y), PointerButton::Primary, Modifiers::NONE);
    hasty.shell.hear(Event::PointerMoved(pos));
    for pressed in [true, false] {
        hasty.shell.hear(Event::PointerButton { pos, button, pressed, modifiers });
        hasty.time += 0.02;
        hasty.shell.frame(hasty.time);
    }
    hasty.press(Key::X, "x");
    assert!(hasty.middle() == patient.middle());
}
