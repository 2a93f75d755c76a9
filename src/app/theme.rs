//! How the window looks: colours, sizes, distances.

/// Gives `ctx` the program's looks.
pub fn install(ctx: &egui::Context) {
    ctx.set_theme(egui::ThemePreference::System);
}
