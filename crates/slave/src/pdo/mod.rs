//! PDO mapping and assignment, and the process image made from them.
//!
//! | module | holds |
//! |---|---|
//! | `list` | objects whose sub-index 0 says how many of their entries count |
//! | `mapping` | what an entry of a mapping object may name |
//! | `assignment` | 0x1600.., 0x1A00.., 0x1C12 and 0x1C13 together |
//! | `image` | a process image: objects at bit offsets |

mod assignment;
mod image;
mod list;
mod mapping;

pub(crate) use assignment::PdoConfiguration;
pub(crate) use image::Image;
pub(crate) use mapping::{Direction, Target};
