//! System fonts for letters that the built-in fonts lack. The built-in fonts have Latin, Greek,
//! Cyrillic and most emoji, in one colour.
//!
//! Nothing is read until such a letter is shown. Then a thread searches the fonts of the system
//! while a box stands in for the letter. The font that it finds is used from the next frame on, so
//! no frame ever waits for a disk. Letters that no font of the system has remain boxes, and
//! [`take_missing`] reports them once.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};

use egui::epaint::text::{
    FallbackRequest, FontInsert, FontPriority, FontProvider, InsertFontFamily,
};
use egui::{Context, Id};
use egui::{FontData, FontFamily};
use fontdb::{Database, FaceInfo, Style};

/// Installs the search for missing letters in the system's fonts.
pub(crate) fn install(ctx: &Context) {
    install_from(ctx, || {
        let mut fonts = Database::new();
        fonts.load_system_fonts();
        fonts
    });
}

fn install_from(ctx: &Context, load: fn() -> Database) {
    let search = Arc::new(Search { ctx: ctx.clone(), load, state: Mutex::default() });
    ctx.data_mut(|data| data.insert_temp(id(), Arc::clone(&search)));
    ctx.add_font_provider(Arc::new(SystemFonts(search)));
}

fn id() -> Id {
    Id::unique("fonts of the system")
}

/// Reports the letters that no font has, if any were found missing since the last call.
pub(crate) fn take_missing(ctx: &Context) -> Option<String> {
    let search: Arc<Search> = ctx.data(|data| data.get_temp(id()))?;
    let missing = std::mem::take(&mut search.lock().missing);
    let code = |letter: &char| format!("U+{:04X}", u32::from(*letter));
    let mut codes: Vec<String> = missing.iter().take(MOST_NAMED).map(code).collect();
    let last = match missing.len().checked_sub(MOST_NAMED) {
        None | Some(0) => codes.pop()?,
        Some(more) => format!("{more} more"),
    };
    let list = if codes.is_empty() { last } else { format!("{} and {last}", codes.join(", ")) };
    let letters = if missing.len() == 1 { "letter" } else { "letters" };
    Some(format!(
        "No installed font has the {letters} {list}, so boxes are shown instead. Install a font \
            that has them, such as one of the Noto family, and restart the program."
    ))
}

/// The maximum number of letters to name.
const MOST_NAMED: usize = 4;

/// The letters to look for, and the fonts found.
#[derive(Default)]
struct Letters {
    /// The letters that the thread has to look for.
    wanted: BTreeSet<char>,
    /// The font of each letter; `None` if no font of the system has the letter.
    found: BTreeMap<char, Option<Font>>,
    /// Letters that no font has and that have not been reported.
    missing: BTreeSet<char>,
    is_searching: bool,
}

/// A face in a font file.
#[derive(Clone, Debug, PartialEq)]
struct Font {
    name: String,
    data: Arc<Vec<u8>>,
    face: u32,
}

struct Search {
    ctx: Context,
    /// Reads the list of fonts.
    load: fn() -> Database,
    state: Mutex<Letters>,
}

struct SystemFonts(Arc<Search>);

impl FontProvider for SystemFonts {
    fn font_for(&self, request: &FallbackRequest<'_>) -> Option<FontInsert> {
        let letter = request.cluster.chars().next()?;
        let mut state = self.0.lock();
        match state.found.get(&letter) {
            Some(font) => font.as_ref().map(Font::insert),
            None => {
                state.wanted.insert(letter);
                if !std::mem::replace(&mut state.is_searching, true) {
                    begin(&self.0, &mut state);
                }
                None
            }
        }
    }
}

impl Search {
    fn lock(&self) -> MutexGuard<'_, Letters> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Starts the thread.
fn begin(search: &Arc<Search>, state: &mut Letters) {
    let (theirs, load) = (Arc::downgrade(search), search.load);
    let work = move || look(&theirs, &load());
    let thread = std::thread::Builder::new().name("fonts".to_owned()).spawn(work);
    // Without a thread, the boxes remain.
    state.is_searching = thread.is_ok();
}

/// Searches the fonts until no more letters are wanted.
fn look(search: &Weak<Search>, fonts: &Database) {
    loop {
        let Some(search) = search.upgrade() else { return };
        // Taking the letters and clearing the flag is one step: a letter added later starts a new
        // thread.
        let wanted = {
            let mut state = search.lock();
            let wanted = std::mem::take(&mut state.wanted);
            state.is_searching = !wanted.is_empty();
            wanted
        };
        if wanted.is_empty() {
            return;
        }
        let mut found = BTreeMap::<char, Option<Font>>::new();
        // A font found for one letter often has the others too.
        for letter in wanted {
            let known = found.values().flatten().find(|font| font.has(letter)).cloned();
            found.insert(letter, known.or_else(|| font_with(fonts, letter)));
        }
        let is_any = found.values().any(Option::is_some);
        let missing = found.iter().filter(|(_, font)| font.is_none()).map(|(letter, _)| *letter);
        let mut state = search.lock();
        state.missing.extend(missing);
        state.found.extend(found);
        drop(state);
        if is_any {
            // New providers make egui ask again, this time with an answer.
            search.ctx.set_font_providers(vec![Arc::new(SystemFonts(Arc::clone(&search)))]);
        }
        search.ctx.request_repaint();
    }
}

/// Finds the most suitable font with a letter: upright, of normal weight, without serifs.
fn font_with(fonts: &Database, letter: char) -> Option<Font> {
    let mut faces: Vec<&FaceInfo> = fonts.faces().collect();
    faces.sort_by_key(|face| {
        let is_sans = face.families.iter().any(|(name, _)| name.contains("Sans"));
        let apart = face.weight.0.abs_diff(400);
        (face.style != Style::Normal, apart, face.monospaced, !is_sans, &face.post_script_name)
    });
    faces.into_iter().find_map(|face| {
        let font = |data: &[u8], index: u32| {
            has(data, index, letter).then(|| Font {
                name: format!("{} {index}", face.post_script_name),
                data: Arc::new(data.to_vec()),
                face: index,
            })
        };
        fonts.with_face_data(face.id, font).flatten()
    })
}

fn has(data: &[u8], face: u32, letter: char) -> bool {
    ttf_parser::Face::parse(data, face).is_ok_and(|face| {
        let glyph = face.glyph_index(letter);
        glyph.is_some_and(|glyph| face.glyph_bounding_box(glyph).is_some())
    })
}

impl Font {
    fn has(&self, letter: char) -> bool {
        has(&self.data, self.face, letter)
    }

    fn insert(&self) -> FontInsert {
        let data = FontData { index: self.face, ..FontData::from_owned(self.data.to_vec()) };
        let family = |family| InsertFontFamily { family, priority: FontPriority::Lowest };
        let families = vec![family(FontFamily::Proportional), family(FontFamily::Monospace)];
        FontInsert { name: self.name.clone(), data, families }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_font_is_found_by_a_letter_that_it_has_and_by_no_other() {
        let mut fonts = Database::new();
        fonts.load_font_data(epaint_default_fonts::UBUNTU_LIGHT.to_vec());
        let font = font_with(&fonts, 'ž').unwrap();
        assert!(font.has('a') && !font.has('山'));
        assert_eq!(font_with(&fonts, '山'), None);
        assert_eq!(font.insert().families.len(), 2);
    }

    #[test]
    fn emoji_need_no_font_of_the_system() {
        let ctx = Context::default();
        ctx.run_ui(egui::RawInput::default(), |_| {}).textures_delta.clear();
        for letter in "🚀🐄🎨🔦🌍😀".chars() {
            let has = |fonts: &mut egui::epaint::text::FontsView<'_>| {
                fonts.has_glyph(&egui::FontId::proportional(14.0), letter)
            };
            assert!(ctx.fonts_mut(has), "{letter} is a box");
        }
    }

    #[test]
    fn a_missing_letter_is_looked_for_once_and_answered_when_it_was_found() {
        let (ctx, load) = (Context::default(), Database::new as fn() -> Database);
        let search = Arc::new(Search { ctx, load, state: Mutex::default() });
        // Pretends that the thread is running already.
        search.lock().is_searching = true;
        let provider = SystemFonts(Arc::clone(&search));
        let family = FontFamily::Proportional;
        let ask = || provider.font_for(&FallbackRequest { cluster: "山", family: &family });
        assert!(ask().is_none() && ask().is_none());
        assert_eq!(search.lock().wanted.len(), 1);
        let data = Arc::new(epaint_default_fonts::UBUNTU_LIGHT.to_vec());
        let font = Font { name: "font".to_owned(), data, face: 0 };
        search.lock().found.insert('山', Some(font));
        assert_eq!(ask().unwrap().name, "font");
    }

    /// Loads a font with a single letter, made by `tests/fonts/make.py`.
    fn mountain() -> Database {
        let mut fonts = Database::new();
        fonts.load_font_data(include_bytes!("../../tests/fonts/mountain.ttf").to_vec());
        fonts
    }

    /// Shows a name until the search for its fonts has ended. Returns whether each letter has a
    /// glyph, and the report about missing letters.
    fn shown(name: &str, load: fn() -> Database) -> (Vec<bool>, Option<String>) {
        let ctx = Context::default();
        install_from(&ctx, load);
        let search: Arc<Search> = ctx.data(|data| data.get_temp(id())).unwrap();
        let show = || ctx.run_ui(egui::RawInput::default(), |ui| drop(ui.label(name)));
        show().textures_delta.clear();
        while search.lock().is_searching {
            std::thread::yield_now();
        }
        show().textures_delta.clear();
        let font = egui::FontId::proportional(14.0);
        let has = |letter| ctx.fonts_mut(|fonts| fonts.has_glyph(&font, letter));
        let glyphs = name.chars().map(has).collect();
        (glyphs, take_missing(&ctx).inspect(|_| assert_eq!(take_missing(&ctx), None)))
    }

    #[test]
    fn a_name_in_han_letters_is_drawn_by_a_font_of_the_system() {
        assert_eq!(shown("山 a", mountain), (vec![true; 3], None));
    }

    #[test]
    fn letters_that_no_font_has_are_said_once_by_their_numbers() {
        let (glyphs, said) = shown("山田a", mountain);
        assert_eq!(glyphs, [true, false, true]);
        let said = said.unwrap();
        assert!(said.starts_with("No installed font has the letter U+7530, so boxes"), "{said}");
        let said = |name| shown(name, Database::new).1.unwrap();
        assert!(said("山田").contains("the letters U+5C71 and U+7530, so"));
        assert!(said("山田川海空雨").contains("U+5C71, U+5DDD, U+6D77, U+7530 and 2 more, so"));
    }
}
