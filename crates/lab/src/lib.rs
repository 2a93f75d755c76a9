//! Measures the time and the error of pictures, and checks that this processor draws the listed
//! pictures bit for bit.
//!
//! ```
//! use marraztu_core::base::image::{Picture, Size};
//! use marraztu_lab::error::Rendering;
//!
//! let size = Size::new(32, 32);
//! let grey = |byte| Picture::filled(size, [byte, byte, byte, 255]);
//! let grey = |byte| Rendering::new(grey(byte), vec![0; size.area()]);
//! let error = grey(102).error(&grey(100));
//! assert_eq!(error.whole.largest, 2);
//! ```

pub mod attribution;
pub mod budget;
pub mod candidates;
pub mod cost;
pub mod dial;
pub mod error;
pub mod estimate;
pub mod flip;
pub mod front;
pub mod hash;
pub mod instructions;
pub mod kernels;
pub mod lost;
pub mod pairs;
pub mod picture_source;
pub mod pictures;
pub mod pixel;
pub mod report;
pub mod statistics;
mod strata;
pub mod suite;
pub mod sweep;
pub mod timing;
pub mod word;
