//! The result of a frame, for the page.

use std::path::PathBuf;

use egui::{ColorImage, CursorIcon, OutputCommand};
use serde::Serialize;

use marraztu::app::{CanvasShell, Painted};

/// What the page has to do after a frame.
#[derive(Debug, Serialize)]
pub(crate) struct Frame {
    /// The rectangles to copy to the canvas, in pixels: x, y, width, height.
    changed: Vec<[i32; 4]>,
    /// The cursor, as in CSS.
    cursor: &'static str,
    /// Text for the clipboard.
    #[serde(skip_serializing_if = "Option::is_none")]
    copied: Option<String>,
    /// The width and height of a picture for the clipboard. [`picture`](crate::picture) returns its
    /// bytes.
    #[serde(skip_serializing_if = "Option::is_none")]
    picture: Option<[usize; 2]>,
    /// A link to open.
    #[serde(skip_serializing_if = "Option::is_none")]
    link: Option<String>,
    /// Where text is being edited, in CSS pixels: x, y, width, height.
    #[serde(skip_serializing_if = "Option::is_none")]
    edited: Option<[f32; 4]>,
    /// The extensions of files that the user wants to open.
    #[serde(skip_serializing_if = "Option::is_none")]
    wants: Option<Vec<&'static str>>,
    /// Scenes that the next frame reads; the page fetches the examples that they refer to.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    opening: Vec<PathBuf>,
    /// The last message and everything reported over the picture, for screen readers.
    said: String,
    /// Whether work would be lost with the page, because it was not saved.
    unsaved: bool,
    /// Why the viewer shows no picture, in a sentence.
    #[serde(skip_serializing_if = "Option::is_none")]
    fault: Option<String>,
    /// The milliseconds until the next frame is due, if it is not only due after an event.
    #[serde(skip_serializing_if = "Option::is_none")]
    due: Option<f64>,
}

impl Frame {
    /// Also returns a picture for the clipboard.
    pub(crate) fn new(shell: &CanvasShell, painted: Painted) -> (Self, Option<ColorImage>) {
        let Painted { changed, output, wants, opening, said, unsaved, fault } = painted;
        let changed = changed
            .into_iter()
            .map(|area| [area.left, area.top, area.width(), area.height()])
            .filter(|[_, _, width, height]| *width > 0 && *height > 0)
            .collect();
        let (mut copied, mut image, mut link) = (None, None, None);
        for command in output.commands {
            match command {
                OutputCommand::CopyText(text) => copied = Some(text),
                OutputCommand::CopyImage(copied) => image = Some(copied),
                OutputCommand::OpenUrl(url) => link = Some(url.url),
                OutputCommand::TextSelectionSettled(_) => {}
            }
        }
        let zoom = shell.zoom();
        let edited = output.ime.map(|ime| {
            let rect = ime.cursor_rect;
            [rect.left(), rect.top(), rect.width(), rect.height()].map(|length| length * zoom)
        });
        let due = shell.due().map(|due| due.as_secs_f64() * 1000.0);
        let cursor = css(output.cursor_icon);
        let picture = image.as_ref().map(|image| image.size);
        let frame = Self {
            changed,
            cursor,
            copied,
            picture,
            link,
            edited,
            wants,
            opening,
            said,
            unsaved,
            fault,
            due,
        };
        (frame, image)
    }
}

/// Returns the name of a cursor in CSS.
const fn css(cursor: CursorIcon) -> &'static str {
    match cursor {
        CursorIcon::None => "none",
        CursorIcon::ContextMenu => "context-menu",
        CursorIcon::Help => "help",
        CursorIcon::PointingHand => "pointer",
        CursorIcon::Progress => "progress",
        CursorIcon::Wait => "wait",
        CursorIcon::Cell => "cell",
        CursorIcon::Crosshair => "crosshair",
        CursorIcon::Text => "text",
        CursorIcon::VerticalText => "vertical-text",
        CursorIcon::Alias => "alias",
        CursorIcon::Copy => "copy",
        CursorIcon::Move => "move",
        CursorIcon::NoDrop => "no-drop",
        CursorIcon::NotAllowed => "not-allowed",
        CursorIcon::Grab => "grab",
        CursorIcon::Grabbing => "grabbing",
        CursorIcon::AllScroll => "all-scroll",
        CursorIcon::ResizeHorizontal => "ew-resize",
        CursorIcon::ResizeNeSw => "nesw-resize",
        CursorIcon::ResizeNwSe => "nwse-resize",
        CursorIcon::ResizeVertical => "ns-resize",
        CursorIcon::ResizeEast => "e-resize",
        CursorIcon::ResizeSouthEast => "se-resize",
        CursorIcon::ResizeSouth => "s-resize",
        CursorIcon::ResizeSouthWest => "sw-resize",
        CursorIcon::ResizeWest => "w-resize",
        CursorIcon::ResizeNorthWest => "nw-resize",
        CursorIcon::ResizeNorth => "n-resize",
        CursorIcon::ResizeNorthEast => "ne-resize",
        CursorIcon::ResizeColumn => "col-resize",
        CursorIcon::ResizeRow => "row-resize",
        CursorIcon::ZoomIn => "zoom-in",
        CursorIcon::ZoomOut => "zoom-out",
        CursorIcon::Default => "default",
    }
}
