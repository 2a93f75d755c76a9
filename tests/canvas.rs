//! The editor in an array of pixels, as in a page of a browser.

use std::path::Path;

use egui::{Event, Key, Modifiers, PointerButton, pos2};
use marraztu::app::{CanvasShell, DrawingServer, Painted};

const SIZE: [usize; 2] = [900, 600];

/// The background of the first scene.
const BLUE: u32 = 0x00_00_b3;

/// A shell with a simulated clock, which advances to the next frame that is due.
struct Page {
    shell: CanvasShell,
    /// What draws the viewport, if the shell itself does not.
    server: Option<DrawingServer>,
    time: f64,
}

impl Page {
    fn open() -> Self {
        let mut page = Self::of(SIZE, 1.0, None);
        page.rest();
        page
    }

    /// Returns a page of another size and scale that has shown no frame yet.
    fn of(size: [usize; 2], scale: f32, file: Option<&Path>) -> Self {
        let files = file.map(Path::to_owned).into_iter().collect();
        let shell = CanvasShell::new(size, scale, files);
        Self { shell, server: None, time: 0.0 }
    }

    /// Returns a page that shows only the picture of a file.
    fn viewer(size: [usize; 2], scale: f32, file: Option<&Path>) -> Self {
        let mut page = Self::of(size, scale, file);
        page.shell.show_picture_only(None);
        page
    }

    /// Opens a page with a server that draws its viewport.
    fn open_with_server() -> Self {
        let mut shell = CanvasShell::new(SIZE, 1.0, Vec::new());
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
                let place = [at % self.shell.size()[0], at / self.shell.size()[0]];
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
        self.shell.pixels()[y * self.shell.size()[0] + x]
    }
}

#[test]
fn the_first_scene_appears_and_keys_and_pointer_change_it() {
    let mut page = Page::open();
    assert_eq!(page.pixel(450, 250), BLUE, "the background of the first scene is blue");
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
        let is_object = |x: usize, y: usize| self.pixel(x, y) != BLUE;
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

/// A phone of 390 x 844 points with three pixels per point, lying and standing, and a 4K screen.
const LARGE: [([usize; 2], u8); 3] = [([1170, 2532], 3), ([2532, 1170], 3), ([3840, 2160], 1)];

#[test]
fn the_picture_reaches_every_corner_of_a_phone_and_of_a_large_screen() {
    for (size, scale) in LARGE {
        let mut page = Page::viewer(size, scale.into(), None);
        page.rest();
        let [right, bottom] = size.map(|count| count - 1);
        for (x, y) in [(0, 0), (right, 0), (0, bottom), (right, bottom)] {
            assert_eq!(page.pixel(x, y), BLUE, "{x}, {y} of {size:?}");
        }
    }
}

#[test]
fn the_picture_of_the_editor_reaches_the_status_line_however_large_the_screen() {
    for (size, scale) in LARGE {
        let mut page = Page::of(size, scale.into(), None);
        page.rest();
        let [width, height] = size;
        let is_blue = |y: &usize| (0..width).any(|x| page.pixel(x, *y) == BLUE);
        let lowest = (0..height).rev().find(is_blue).expect("the first scene is shown");
        let bar = 40 * usize::from(scale);
        assert!(lowest + bar > height, "{size:?}: the picture ends at {lowest}");
    }
}

#[test]
fn a_viewer_says_why_it_cannot_show_a_file_and_opens_no_dialog() {
    let folder = tempfile::tempdir().unwrap();
    let files = [
        ("empty.obj", ""),
        ("page.obj", "<!doctype html><title>404</title>"),
        ("cut.stl", "solid cut"),
        ("broken.marraztu", "(version: 1, objects: ["),
    ];
    let mut first = Page::viewer(SIZE, 1.0, None);
    let painted = first.rest();
    assert!(painted.iter().all(|frame| frame.fault.is_none()));
    for (name, text) in files {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        let mut page = Page::viewer(SIZE, 1.0, Some(&path));
        let fault = page.rest().pop().and_then(|frame| frame.fault).unwrap_or_default();
        assert!(fault.contains(name), "{name}: {fault}");
        assert!(page.shell.pixels() == first.shell.pixels(), "{name} opens a dialog");
        // The editor says it in a dialog.
        let mut page = Page::of(SIZE, 1.0, Some(&path));
        assert!(page.rest().iter().all(|frame| frame.fault.is_none()), "{name}");
    }
}

#[test]
fn the_host_knows_whether_work_would_be_lost() {
    let mut page = Page::open();
    let is_unsaved = |frames: Vec<Painted>| frames.last().is_some_and(|frame| frame.unsaved);
    // Looking around and choosing what the keys act on is no work.
    assert!(!is_unsaved(page.press(Key::C, "c")));
    assert!(is_unsaved(page.press(Key::X, "x")));
    let command = Modifiers::COMMAND | Modifiers::CTRL;
    for pressed in [true, false] {
        let (key, physical_key, repeat, modifiers) = (Key::Z, None, false, command);
        page.shell.hear(Event::Key { key, physical_key, pressed, repeat, modifiers });
    }
    assert!(!is_unsaved(page.rest()), "undone work is not lost");
}

#[test]
fn a_sentence_of_the_host_is_shown_even_if_a_model_is_being_opened() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("square.obj");
    std::fs::write(&path, "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n").unwrap();
    for file in [None, Some(&*path)] {
        let mut page = Page::of(SIZE, 1.0, file);
        page.shell.tell("this is not kept".to_owned());
        let is_told = |frame: &Painted| {
            let opened = file.is_none() || frame.said.contains("Opened square");
            opened && frame.said.contains("this is not kept")
        };
        assert!(page.rest().iter().any(is_told), "{file:?}");
    }
}

#[test]
fn an_area_beyond_an_edge_of_the_canvas_is_refused_rather_than_wrapped() {
    let page = Page::open();
    let [width, height] = SIZE;
    let mut bytes = Vec::new();
    assert!(page.shell.copy_rgba([448, 249], [3, 2], &mut bytes));
    assert_eq!(bytes, [0, 0, 0xb3, 255].repeat(6));
    assert!(page.shell.copy_rgba([width - 2, height - 3], [2, 3], &mut bytes));
    assert_eq!(bytes.len(), 4 * 2 * 3);
    let beyond = [
        ([width - 1, 0], [2, 1]),
        ([width, 0], [1, 1]),
        ([0, height - 1], [1, 2]),
        ([0, height], [1, 1]),
        ([1, 0], [width, height]),
        ([usize::MAX, 0], [2, 1]),
        ([0, usize::MAX], [1, 2]),
    ];
    for (at, size) in beyond {
        assert!(!page.shell.copy_rgba(at, size, &mut bytes), "{at:?}, {size:?}");
    }
}

#[test]
fn the_dialogs_of_a_phone_have_margins() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a model with a rather long name that is cut off in a phone.obj");
    std::fs::write(&path, "").unwrap();
    let [width, height] = [390, 844];
    let mut page = Page::of([width, height], 1.0, Some(&path));
    page.rest();
    // Dialogs are in the middle of the window, and most of a row is their background.
    let row: Vec<u32> = (0..width).map(|x| page.pixel(x, height / 2)).collect();
    let count = |color: u32| row.iter().filter(|other| **other == color).count();
    let background = row.iter().copied().max_by_key(|color| count(*color));
    assert_ne!(Some(page.pixel(3, 3)), background, "no dialog is open");
    for x in [3, width - 4] {
        assert_ne!(Some(row[x]), background, "the dialog is cut off at {x}");
    }
}

#[test]
fn notices_that_end_in_the_same_frame_both_move_to_the_status_line() {
    let mut page = Page::open();
    for sentence in ["the first sentence", "the second sentence"] {
        page.shell.tell(sentence.to_owned());
    }
    let frames = page.rest();
    // Notices of one kind are one, with a count.
    let shown = |frame: &Painted| frame.said.contains("sentence");
    assert!(frames.iter().any(shown));
    assert!(!frames.last().is_some_and(shown), "the notices have gone");
}
